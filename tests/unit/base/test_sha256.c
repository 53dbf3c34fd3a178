/* SHA-256 against FIPS 180-4: the standard's own examples, and lengths where the padding goes over into another block,
 * 55/56 and 63/64 bytes (digests by Python's hashlib). All comparisons are exact. */
#include "support.h"

#include "base/sha256.h"

#include <stdlib.h>
#include <string.h>

static const struct {
    const char *text, *hex;
} fips[] = {
    {"abc", "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad"},
    {"abcdbcdecdefdefgefghfghighijhijkijkljklmklmnlmnomnopnopq",
     "248d6a61d20638b8e5c026930c3e6039a33ce45964ff2167f6ecedd419db06c1"},
    {"abcdefghbcdefghicdefghijdefghijkefghijklfghijklmghijklmnhijklmnoijklmnopjklmnopqklmnopqrlmnopqrsmnopqrstnopqrstu",
     "cf5b16a778af8380036ce59e7b0492370b249b11e8f07a51afac45037afee9d1"},
    {"", "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855"},
};

START_TEST(published_vectors)
{
    char hex[65];
    hf_sha256(fips[_i].text, strlen(fips[_i].text), hex);
    ck_assert_str_eq(hex, fips[_i].hex);
}
END_TEST

START_TEST(million_of_a)
{
    char hex[65], *text = malloc(1000000);
    ck_assert_ptr_nonnull(text);
    memset(text, 'a', 1000000);
    hf_sha256(text, 1000000, hex);
    free(text);
    ck_assert_str_eq(hex, "cdc76e5c9914fb9281a1c7e284d73e67f1809a48a497200e046d39ccc7112cd0");
}
END_TEST

/* n bytes 'x' */
static const struct {
    size_t n;
    const char *hex;
} padded[] = {
    {1, "2d711642b726b04401627ca9fbac32f5c8530fb1903cc4db02258717921a4881"},
    {54, "45f316e10b2c99abf374b22bda893cf3300d77263f1e272349ed414680522952"},
    {55, "d5e285683cd4efc02d021a5c62014694958901005d6f71e89e0989fac77e4072"},
    {56, "04c26261370ee7541549d16dee320c723e3fd14671e66a099afe0a377c16888e"},
    {57, "ae14a2563ccf969d99aca69ce6bb74981f734bbf9f655f73b8f06db68cab5217"},
    {63, "75220b47218278e656f2013bb8f0c455a25eaf01e86c64924e9d48d89776d6f2"},
    {64, "7ce100971f64e7001e8fe5a51973ecdfe1ced42befe7ee8d5fd6219506b5393c"},
    {65, "9537c5fdf120482f7d58d25e9ed583f52c02b4e304ea814db1633ad565aed7e9"},
    {119, "000b48d4edf0fa7bee3c6236ecd2785baa5db4eeb8bb54341b029e0d9fa5fb0c"},
    {120, "13f05a0b594787f5ecd315edc96141bd3243203d1b7d4f0836f37308b276ba98"},
    {127, "70156a14adbabf98cff3a71c7084b417abf057a8efd27329ca36b7202c87d81f"},
    {128, "24da1b81d0b16df6428eee73c69fcb2a93c76bc6df706f0c6670fe6bfe800464"},
    {129, "0ec9eb33e74510bcdd1f2ea55206e82f21649c5c2becbf2b433eb475b34c01bd"},
    {183, "b95933e340383f43cfb72bb337fbb80bd93b9f54f5b49f5cd9635d2c62e7f386"},
    {184, "f3936e2eb513e068318995db8ff8a043fe9cbcf079934b8dfd49046c0fca45be"},
};

START_TEST(lengths_around_a_block)
{
    char text[256], hex[65];
    memset(text, 'x', sizeof text);
    hf_sha256(text, padded[_i].n, hex);
    ck_assert_str_eq(hex, padded[_i].hex);
}
END_TEST

/* Case files may hold any byte. */
START_TEST(every_byte_value)
{
    unsigned char bytes[256];
    char hex[65];
    for (int i = 0; i < 256; i++)
        bytes[i] = (unsigned char)i;
    hf_sha256(bytes, sizeof bytes, hex);
    ck_assert_str_eq(hex, "40aff2e9d2d8922e47afd4648e6967497158785fbd1da870e7110266bf944880");
}
END_TEST

Suite *suite_unit_sha256(void)
{
    Suite *suite = suite_create("unit/sha256");
    TCase *tests = tcase_create("sha256");
    suite_add_tcase(suite, tests);
    tcase_add_loop_test(tests, published_vectors, 0, sizeof fips / sizeof *fips);
    tcase_add_test(tests, million_of_a);
    tcase_add_loop_test(tests, lengths_around_a_block, 0, sizeof padded / sizeof *padded);
    tcase_add_test(tests, every_byte_value);
    return suite;
}
