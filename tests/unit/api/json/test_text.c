// UTF-8 as it may come from clients, pieces of lines, and words of lists.

#include "api/json/text.h"
#include "tests/unit/helper_cmocka.h"

// The first and last character of each length, by RFC 3629.
static void characters_have_their_size(void **state)
{
    static const struct {
        const char *text;
        size_t n;
    } good[] = {
        { "\x01", 1 },
        { "\x7f", 1 },
        { "\xc2\x80", 2 },
        { "\xdf\xbf", 2 },
        { "\xe0\xa0\x80", 3 },
        { "\xed\x9f\xbf", 3 },
        { "\xee\x80\x80", 3 },
        { "\xef\xbf\xbf", 3 },
        { "\xf0\x90\x80\x80", 4 },
        { "\xf4\x8f\xbf\xbf", 4 },
    };

    for (size_t k = 0; k < sizeof good / sizeof *good; k++) {
        assert_int_equal(text_utf8_size(good[k].text), good[k].n);
        assert_true(text_is_utf8(good[k].text));
    }
    assert_int_equal(text_utf8_size(""), 0);
    assert_true(text_is_utf8(""));
    assert_true(text_is_utf8("belt 7 \xc3\xbc \xf0\x9f\x93\xa6"));
}

// Stray, torn, overlong, a surrogate, beyond the last character.
static void other_bytes_are_no_text(void **state)
{
    static const char *const bad[] = { "\x80",
                                       "\xc3",
                                       "\xc3(",
                                       "\xe2\x82",
                                       "\xc0\xaf",
                                       "\xe0\x80\xaf",
                                       "\xf0\x80\x80\xaf",
                                       "\xed\xa0\x80",
                                       "\xf4\x90\x80\x80",
                                       "\xff" };

    for (size_t k = 0; k < sizeof bad / sizeof *bad; k++) {
        assert_int_equal(text_utf8_size(bad[k]), 0);
        assert_false(text_is_utf8(bad[k]));
    }
    assert_false(text_is_utf8("good, then \xff"));
}

static void pieces_are_taken_until_nothing_is_left(void **state)
{
    static const char *const expected[] = { "t_s", "", "n", "" };
    const text_piece line = { "t_s,,n,|beyond", 7 };
    text_piece rest = line;

    assert_int_equal(text_count_pieces(line, ','), 4);
    assert_int_equal(text_count_pieces(line, '|'), 1);
    for (size_t k = 0; k < 4; k++)
        assert_true(text_is(text_take_until(&rest, ','), expected[k]));
    assert_int_equal(rest.n, 0);
    assert_true(text_is(text_take_until(&rest, ','), ""));
    assert_false(text_is(line, "t_s,,n"));
    assert_false(text_is(line, "t_s,,n;"));
}

static void a_word_has_its_index_and_another_that_of_the_end(void **state)
{
    static const char *const words[] = { "one", "two", "three", NULL };

    assert_int_equal(text_find_word(words, 3, "one"), 0);
    assert_int_equal(text_find_word(words, 3, "three"), 2);
    assert_int_equal(text_find_word(words, 2, "three"), 2);
    assert_int_equal(text_find_word(words, 3, "thre"), 3);
    assert_int_equal(text_find_word(words, SIZE_MAX, ""), 3);
    assert_int_equal(text_find_word(words, 0, "one"), 0);
    assert_true(text_has_word(words, "three"));
    assert_false(text_has_word(words, "threes"));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(characters_have_their_size),
        cmocka_unit_test(other_bytes_are_no_text),
        cmocka_unit_test(pieces_are_taken_until_nothing_is_left),
        cmocka_unit_test(a_word_has_its_index_and_another_that_of_the_end),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
