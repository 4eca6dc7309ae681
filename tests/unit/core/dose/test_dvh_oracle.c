/* Histograms of real plans against numpy, which reads the files by itself, and against the planning program's table. */
#include "core/dose/dvh_metrics.h"
#include "core/plan/plan.h"
#include "tests/check.h"
#include "tests/unit/data_folder.h"
#include "tests/unit/oracle.h"
#include "tests/unit/plan_help.h"

enum { N_FIGURES = 8, N_TABLE = 5 };
static const char *const words[N_FIGURES] = { "mean", "min", "max", "D98%", "D95%", "D50%", "D2%", "V20" };

static const struct region *region_of_file(const struct plan *plan, const char *name)
{
    for (size_t r = 0; r < plan->regions.n_regions; r++)
        if (strcmp(plan->regions.regions[r].name, name) == 0)
            return &plan->regions.regions[r];
    fail_msg("no region %s", name);
    return NULL;
}

static void figures_of(const struct plan *plan, const struct region *region, bool is_general, double found[N_FIGURES],
                       double *n)
{
    const struct volume *rows[1] = { plan->doses[0].components[0].values };
    struct dvh_sweep sweep = {
        .labels = plan->regions.layers[region->layer], .rows = rows, .n_rows = 1, .is_general = is_general
    };
    struct dvh_label label = { region->label, 1 };
    struct dvh dvh;
    struct error err = { 0 };
    if (!dvh_sweep(&sweep, &label, 1, &dvh, &err))
        fail_msg("%s", err.text);
    for (int f = 0; f < N_FIGURES; f++) {
        struct dvh_metric metric;
        assert_true(dvh_metric_parse(words[f], &metric, &err));
        found[f] = dvh_metric_value(&dvh, &metric);
    }
    *n = dvh.n;
    assert_close(dvh.n_missing, 0, 0);
    dvh_finish(&dvh);
}

/* Structures of which the table's volume and ours agree to 1 %, and whose dose does not rise so steeply that the rest
 * of that percent shows: 0 for a figure that is not held to the table. */
static const struct {
    const char *name;
    double mean, d95, d50, d2; /* allowed deviation */
} table[] = {
    { "PTV1", 0.01, 0.01, 0.01, 0.01 },  { "CTV", 0.01, 0.01, 0.01, 0.01 }, { "GTV", 0.01, 0.01, 0.01, 0.01 },
    { "optBRAIN", 0.01, 0, 0.01, 0.01 }, { "BRAIN", 0.01, 0, 0, 0.01 },
};

static void compare(const char *kind, const char *set, size_t n_expected)
{
    static char out[1 << 16];
    char folder[512];
    struct plan *plan = plan_of_data(set);
    if (!plan || !data_path(set, folder, sizeof folder))
        skip();
    char *arguments[] = { oracle_python(), "tests/oracle/dvh_values.py", (char *)(uintptr_t)kind, folder, NULL };
    int status = oracle_run(arguments, out, sizeof out);
    if (status == ORACLE_MISSING) {
        plan_destroy(plan);
        skip();
    }
    assert_int_equal(status, 0);
    size_t n_structures = 0;
    for (char *rest = out, *line; (line = strtok_r(rest, "\n", &rest));) {
        char *at, *name = strtok_r(line, " ", &at);
        double theirs[1 + N_FIGURES + N_TABLE], n, found[N_FIGURES];
        for (size_t i = 0; i < sizeof theirs / sizeof *theirs; i++)
            theirs[i] = strtod(at, &at);
        for (int way = 0; way < 2; way++) {
            figures_of(plan, region_of_file(plan, name), way, found, &n);
            assert_close(n, theirs[0], 0);
            for (int f = 0; f < N_FIGURES; f++)
                if (!(fabs(found[f] - theirs[1 + f]) <= (f < 3 ? 1e-5 : 5e-3) * fabs(theirs[1 + f]) + 1e-9))
                    fail_msg("%s of %s is %.9g, numpy says %.9g", words[f], name, found[f], theirs[1 + f]);
        }
        for (size_t t = 0; theirs[1 + N_FIGURES] > 0 && t < sizeof table / sizeof *table; t++) {
            const double limits[4] = { table[t].mean, table[t].d95, table[t].d50, table[t].d2 };
            static const int figure[4] = { 0, 4, 5, 6 };
            for (int f = 0; f < 4 && strcmp(table[t].name, name) == 0; f++)
                if (limits[f] > 0)
                    assert_near(found[figure[f]], theirs[1 + N_FIGURES + f], limits[f]);
        }
        n_structures++;
    }
    assert_int_equal(n_structures, n_expected);
    plan_destroy(plan);
}

static void a_brain_plan_has_the_figures_of_numpy_and_of_the_planning_program(void **state)
{
    (void)state;
    compare("eclipse", "eclipse-ent-dose", 16);
}

static void a_head_and_neck_plan_has_the_figures_of_numpy(void **state)
{
    (void)state;
    compare("openkbp", "openkbp-pt99", 10);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_brain_plan_has_the_figures_of_numpy_and_of_the_planning_program),
        cmocka_unit_test(a_head_and_neck_plan_has_the_figures_of_numpy),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
