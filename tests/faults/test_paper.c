/* Orders to beamroom-paper, while an allocation or a read fails: an order is whole, or there is none. */
#include "server/printer/order.h"
#include "tests/check.h"
#include "tests/faults/walk.h"

static const char json[] = "{\"title\":\"Record\",\"blocks\":[{\"type\":\"text\",\"text\":\"As shown\"}]}";
static const unsigned char picture[3000] = { 0xff, 0xd8 };

struct bytes {
    unsigned char at[sizeof(struct printer_head) + sizeof json + 2 * sizeof picture];
    size_t n, next;
};

static bool take(void *context, void *to, size_t n)
{
    struct bytes *bytes = context;
    if (n > bytes->n - bytes->next)
        return false;
    memcpy(to, bytes->at + bytes->next, n);
    bytes->next += n;
    return true;
}

static void put(struct bytes *bytes, const void *from, size_t n)
{
    memcpy(bytes->at + bytes->n, from, n);
    bytes->n += n;
}

static void read_order(void *context, struct outcome *outcome)
{
    const struct printer_head head = { .magic = PRINTER_MAGIC,
                                       .n_json = sizeof json - 1,
                                       .n_pictures = { sizeof picture, 0, sizeof picture, 0 } };
    struct bytes bytes = { .n = 0 };
    struct order order;
    (void)context;
    put(&bytes, &head, sizeof head);
    put(&bytes, json, sizeof json - 1);
    put(&bytes, picture, sizeof picture);
    put(&bytes, picture, sizeof picture);
    outcome->is_done = order_read(&order, take, &bytes);
    faults_pause();
    if (outcome->is_done) {
        char *text = json_print(order.input.paper);
        outcome_add_text(outcome, text);
        free(text);
        for (int i = 0; i < PRINTER_PICTURES; i++)
            outcome_add(outcome, order.input.pictures[i] ? order.input.pictures[i] : (const unsigned char *)"", 1);
        outcome_add_number(outcome, (double)(bytes.n - bytes.next));
    } else {
        (void)error_set(&outcome->err, ERROR_MEMORY, "the order is not whole");
    }
    faults_go_on();
    order_finish(&order);
}

int main(void)
{
    const struct walk orders = { .name = "an order is read", .run = read_order, .kinds = { [FAULT_MEMORY] = true } };
    walk_run(&orders);
    return walks_end();
}
