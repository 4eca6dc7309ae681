/* Unix sockets: their settings, their files, and who is at the other end. */
#include "server/front/local_socket.h"

#include <grp.h>
#include <pwd.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

#include "tests/check.h"

static char folder[64], path[100];

static int make_folder(void **state)
{
    (void)state;
    (void)snprintf(folder, sizeof folder, "/tmp/beamroom-socket-XXXXXX");
    assert_non_null(mkdtemp(folder));
    (void)snprintf(path, sizeof path, "%s/http.sock", folder);
    return 0;
}

static int remove_folder(void **state)
{
    (void)state;
    (void)unlink(path);
    return rmdir(folder);
}

static int connect_to(const char *where)
{
    struct sockaddr_un address = { .sun_family = AF_UNIX };
    (void)snprintf(address.sun_path, sizeof address.sun_path, "%s", where);
    int client = socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0);
    if (connect(client, (struct sockaddr *)&address, sizeof address) == 0)
        return client;
    close(client);
    return -1;
}

static void the_setting_has_one_form(void **state)
{
    (void)state;
    static const char *const bad[] = { "unix:",
                                       "unix:http.sock",
                                       "unix:/a,",
                                       "unix:/a,mode=",
                                       "unix:/a,mode=8",
                                       "unix:/a,mode=-1",
                                       "unix:/a,mode=1777",
                                       "unix:/a,mode=066 ",
                                       "unix:/a,group=",
                                       "unix:/a,user=root",
                                       "unix:/a,group=x,,mode=0660" };
    struct local_socket local;
    struct error err = { 0 };
    assert_true(local_socket_is_meant("unix:/a"));
    assert_false(local_socket_is_meant("127.0.0.1:80"));
    assert_true(local_socket_read("unix:/run/b/http.sock", &local, &err));
    assert_string_equal(local.path, "/run/b/http.sock");
    assert_string_equal(local.group, "");
    assert_int_equal(local.mode, 0660);
    assert_true(local_socket_read("unix:/a,mode=0600,group=www-data", &local, &err));
    assert_string_equal(local.path, "/a");
    assert_string_equal(local.group, "www-data");
    assert_int_equal(local.mode, 0600);
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++) {
        err = (struct error){ 0 };
        if (local_socket_read(bad[i], &local, &err) || !strstr(err.text, "expected unix:/PATH"))
            fail_msg("%s: %s", bad[i], err.text);
    }
    for (size_t more = 0; more < 2; more++) {
        char longest[200] = "unix:/";
        memset(longest + 6, 'a', LOCAL_SOCKET_MAX_PATH - 1 + more);
        assert_int_equal(local_socket_read(longest, &local, &err), more == 0);
    }
}

static void a_dead_socket_is_replaced_and_one_in_use_is_not(void **state)
{
    (void)state;
    char text[150];
    struct local_socket first, second;
    struct error err = { 0 };
    struct stat facts;
    (void)snprintf(text, sizeof text, "unix:%s,mode=0640", path);
    assert_true(local_socket_read(text, &first, &err) && local_socket_read(text, &second, &err));
    int listener = local_socket_open(&first, &err);
    assert_true(listener >= 0);
    assert_int_equal(stat(path, &facts), 0);
    assert_int_equal(facts.st_mode & 0777, 0640);
    assert_int_equal(local_socket_open(&second, &err), -1);
    assert_non_null(strstr(err.text, "another process listens there"));
    int client = connect_to(path);
    assert_true(client >= 0);
    close(client);

    close(listener); /* as by a kill: the file stays */
    listener = local_socket_open(&second, &err);
    assert_true(listener >= 0);
    local_socket_remove(&second);
    assert_int_not_equal(access(path, F_OK), 0);
    close(listener);
    listener = local_socket_open(&first, &err);
    char moved[110];
    (void)snprintf(moved, sizeof moved, "%s.moved", path);
    assert_int_equal(rename(path, moved), 0);
    FILE *other = fopen(path, "w");
    assert_non_null(other);
    fclose(other);
    local_socket_remove(&first); /* another file has its name */
    assert_int_equal(access(path, F_OK), 0);
    unlink(moved);
    close(listener);
}

static void other_files_are_left_alone(void **state)
{
    (void)state;
    char text[150];
    struct local_socket local;
    struct error err = { 0 };
    FILE *file = fopen(path, "w");
    assert_non_null(file);
    fclose(file);
    (void)snprintf(text, sizeof text, "unix:%s", path);
    assert_true(local_socket_read(text, &local, &err));
    assert_int_equal(local_socket_open(&local, &err), -1);
    assert_non_null(strstr(err.text, "no socket"));
    assert_int_equal(access(path, F_OK), 0);
    unlink(path);
    (void)snprintf(text, sizeof text, "unix:%s,group=no-such-group-here", path);
    assert_true(local_socket_read(text, &local, &err));
    assert_int_equal(local_socket_open(&local, &err), -1);
    assert_non_null(strstr(err.text, "there is no group no-such-group-here"));
    assert_int_not_equal(access(path, F_OK), 0);
}

static void a_peer_is_known_by_its_user_or_its_group(void **state)
{
    (void)state;
    int pair[2];
    struct local_process found;
    assert_int_equal(socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, pair), 0);
    const struct local_peers nobody = { 0 }, user = { .has_user = true, .user = geteuid(), .group = getegid() + 1 },
                             group = { .has_group = true, .user = geteuid() + 1, .group = getegid() },
                             others = { true, true, geteuid() + 1, getegid() + 1 };
    assert_false(local_peers_have(&nobody, pair[0], &found));
    assert_int_equal(found.user, geteuid());
    assert_int_equal(found.group, getegid());
    assert_true(local_peers_have(&user, pair[0], &found));
    assert_true(local_peers_have(&group, pair[0], &found));
    assert_false(local_peers_have(&others, pair[0], &found));
    close(pair[0]);
    close(pair[1]);
    struct local_peers peers;
    struct error err = { 0 };
    assert_true(local_peers_find("root", &peers, &err));
    assert_true(peers.has_user && peers.user == 0 && peers.has_group && peers.group == 0);
    assert_false(local_peers_find("no-such-user-here", &peers, &err));
    assert_non_null(strstr(err.text, "no-such-user-here"));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_setting_has_one_form),
        cmocka_unit_test_setup_teardown(a_dead_socket_is_replaced_and_one_in_use_is_not, make_folder, remove_folder),
        cmocka_unit_test_setup_teardown(other_files_are_left_alone, make_folder, remove_folder),
        cmocka_unit_test(a_peer_is_known_by_its_user_or_its_group),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
