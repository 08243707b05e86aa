#include "core/scene/json_reader.h"

#include <gtest/gtest.h>

#include <bit>
#include <clocale>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <random>
#include <string>
#include <string_view>
#include <vector>

#include "tests/error_line.h"

namespace ivory {
namespace {

using tests::error_line;

JsonDocument parse(std::string_view text) { return parse_json(SourceText(text, "x")); }

template <class Item>
std::vector<Item> listed(const JsonRange<Item>& range) {
    return {range.begin(), range.end()};
}

std::string fault_of(std::string_view text) {
    return error_line([&] { static_cast<void>(parse(text)); });
}

// Of a number that ends the text or nearly, and of one that does not.
double number(const std::string& text) {
    const JsonDocument alone = parse(text);
    const std::string list = "[" + text + "          ]";
    const JsonDocument document = parse(list);
    const double value = (*document.root().items().begin()).number();
    EXPECT_EQ(std::bit_cast<std::uint64_t>(alone.root().number()),
              std::bit_cast<std::uint64_t>(value))
        << text;
    return value;
}

TEST(JsonReader, KeepsEveryKindOfValue) {
    const JsonDocument document =
        parse(R"({"z": null, "a": [true, false, "é\n\u00e9", -1.5], "o": {}})");
    ASSERT_EQ(document.root().kind(), JsonKind::object);
    const auto members = listed(document.root().members());
    ASSERT_EQ(members.size(), 3U);
    EXPECT_EQ(members[0].key.text(), "z");  // in file order
    EXPECT_EQ(members[0].value.kind(), JsonKind::null);
    ASSERT_EQ(members[1].value.kind(), JsonKind::list);
    const auto items = listed(members[1].value.items());
    ASSERT_EQ(items.size(), 4U);
    EXPECT_EQ(items[0].kind(), JsonKind::boolean);
    EXPECT_TRUE(items[0].boolean());
    EXPECT_EQ(items[1].kind(), JsonKind::boolean);
    EXPECT_FALSE(items[1].boolean());
    EXPECT_EQ(items[2].kind(), JsonKind::text);
    EXPECT_EQ(items[2].text(), "é\né");
    EXPECT_EQ(items[3].kind(), JsonKind::number);
    EXPECT_EQ(items[3].number(), -1.5);
    EXPECT_EQ(members[2].value.kind(), JsonKind::object);
    EXPECT_EQ(members[2].value.members().size(), 0U);
    const auto found = find_member(document.root(), "o");
    ASSERT_TRUE(found);
    EXPECT_EQ(found->offset(), members[2].value.offset());
    EXPECT_FALSE(find_member(document.root(), "p"));
}

TEST(JsonReader, TextIsWhatItsEscapesStandFor) {
    const JsonDocument document =
        parse(R"(["\"\\\/\b\f\n\r\t", "a\u0041\u00e9\u20AC\ud83e\udda3\u0000z", "\\u0041"])");
    const auto items = listed(document.root().items());
    EXPECT_EQ(items[0].text(), "\"\\/\b\f\n\r\t");
    EXPECT_EQ(items[1].text(), std::string("aAé€🦣\0z", 13));
    EXPECT_EQ(items[2].text(), "\\u0041");
    EXPECT_TRUE(parse(R"("\u0041")").root().is_word("A"));
    EXPECT_FALSE(items[2].is_word("A"));
}

TEST(JsonReader, NumbersAreTheNearestDoubles) {
    EXPECT_EQ(number("9007199254740993"), 9007199254740992.0);  // 2^53 + 1, a tie: to even
    EXPECT_EQ(number("9007199254740995"), 9007199254740996.0);
    EXPECT_EQ(number("-9007199254740993"), -9007199254740992.0);
    EXPECT_EQ(number("18446744073709551615"), 0x1p64);
    EXPECT_EQ(number("18446744073709551616"), 0x1p64);
    EXPECT_EQ(number("-9223372036854775809"), -0x1p63);
    EXPECT_EQ(number("0.1"), 0.1);
    EXPECT_EQ(number("1E2"), 100.0);
    // Just beyond the tie between 1 and the next double.
    EXPECT_EQ(number("1.00000000000000011102230246251565404236316680908203125"), 1.0);
    EXPECT_EQ(number("1.00000000000000011102230246251565404236316680908203126"),
              std::nextafter(1.0, 2.0));
    EXPECT_EQ(number("1.7976931348623158e308"), 1.7976931348623157e308);
    EXPECT_EQ(number("4.9406564584124654e-324"), 5e-324);
    EXPECT_EQ(number("2.4703282292062327e-324"), 0.0);  // below half the least
    EXPECT_EQ(number("2.4703282292062328e-324"), 5e-324);
    EXPECT_EQ(number("1e-999"), 0.0);
}

// Of any number of digits before and behind the point, with and without an exponent.
TEST(JsonReader, NumbersAreThoseOfTheCLibrary) {
    const auto seed = std::random_device{}();
    SCOPED_TRACE("seed " + std::to_string(seed));
    std::mt19937 random(seed);
    const auto digits = [&](std::size_t count) {
        std::string text;
        while (text.size() < count) text += static_cast<char>('0' + random() % 10);
        return text;
    };
    for (std::size_t i = 0; i < 50'000; ++i) {
        std::string text = i % 2 == 0 ? "-" : "";
        text += i % 3 == 0 ? "0" : "1" + digits(random() % 20);
        if (i % 7 != 0) text += "." + digits(1 + random() % 20);
        if (i % 11 == 0) text += "e-" + digits(1 + random() % 2);
        ASSERT_EQ(std::bit_cast<std::uint64_t>(number(text)),
                  std::bit_cast<std::uint64_t>(std::strtod(text.c_str(), nullptr)))
            << text;
    }
}

TEST(JsonReader, KeepsTheSignOfZero) {
    for (const char* const zero : {"-0", "-0.0", "-0e5", "-1e-999"}) {
        EXPECT_TRUE(std::signbit(number(zero))) << zero;
    }
    for (const char* const zero : {"0", "0.0", "1e-999"}) {
        EXPECT_FALSE(std::signbit(number(zero))) << zero;
    }
}

TEST(JsonReader, NumbersDoNotDependOnTheLocale) {
    const std::string before = std::setlocale(LC_NUMERIC, nullptr);
    const char* changed = nullptr;
    for (const char* const name : {"de_DE.UTF-8", "fr_FR.UTF-8", "da_DK.UTF-8", "de_DE.utf8"}) {
        if (changed == nullptr) changed = std::setlocale(LC_NUMERIC, name);
    }
    if (changed == nullptr) GTEST_SKIP() << "no locale with a decimal comma is installed";
    const double value = number("0.5");
    std::setlocale(LC_NUMERIC, before.c_str());
    EXPECT_EQ(value, 0.5);
}

TEST(JsonReader, KnowsWhereEachValueStands) {
    const std::string_view text = "\n{ \"a\\\"b\" : [ 10 ,-2.5,{\"c\":true}] ,\n\"d\":\"]\" }";
    const JsonDocument document = parse(text);
    const auto from = [&](const JsonValue& value) { return text.substr(value.offset()); };
    EXPECT_EQ(document.root().offset(), 1U);
    const auto members = listed(document.root().members());
    EXPECT_TRUE(from(members[0].key).starts_with("\"a\\\"b\" :"));
    EXPECT_TRUE(from(members[0].value).starts_with("[ 10"));
    const auto items = listed(members[0].value.items());
    EXPECT_TRUE(from(items.at(0)).starts_with("10 ,"));
    EXPECT_TRUE(from(items.at(1)).starts_with("-2.5,"));
    EXPECT_TRUE(from(items.at(2)).starts_with("{\"c\""));
    EXPECT_TRUE(from((*items.at(2).members().begin()).value).starts_with("true"));
    EXPECT_TRUE(from(members[1].key).starts_with("\"d\""));
    EXPECT_TRUE(from(members[1].value).starts_with("\"]\""));
}

TEST(JsonReader, CountsColumnsInCharactersAndPassesOverAByteOrderMark) {
    EXPECT_EQ(fault_of("[\n \"é∑🦣\", x]"),
              "x: line 2, column 9: not JSON: invalid literal at \"x\"; expected '[', '{', or a "
              "literal");
    EXPECT_EQ(parse("\xEF\xBB\xBF[1]").root().offset(), 3U);
    EXPECT_EQ(fault_of("\xEF\xBB\xBF[x]"),
              "x: line 1, column 2: not JSON: invalid literal at \"x\"; expected '[', '{', or a "
              "literal");
    EXPECT_EQ(fault_of("\xEF\xBB\xBF"),
              "x: line 1, column 1: the text ends where a value should stand; it must be one JSON "
              "object");
}

TEST(JsonReader, RefusesDuplicateKeysAtEveryLevel) {
    const std::string remedy = " stands here for the second time in its object; keep one";
    EXPECT_EQ(fault_of(R"({"a": 1, "b": 2, "a": 1})"),
              "x: /a (line 1, column 18): the key \"a\"" + remedy);
    EXPECT_EQ(fault_of(R"([0, {"a": {"b": [{}, {"c": 1, "\u0063": 2}]}}])"),
              "x: /1/a/b/1/c (line 1, column 31): the key \"c\"" + remedy);
    EXPECT_EQ(fault_of(R"({"": 1, "": 1})"), "x: / (line 1, column 9): the key \"\"" + remedy);
    EXPECT_EQ(fault_of(R"({"~/": 1, "~/": 1})"),
              "x: /~0~1 (line 1, column 11): the key \"~/\"" + remedy);
    // Before the fault that comes later in the text.
    EXPECT_EQ(fault_of(R"({"a": 1, "a": nonsense)"),
              "x: /a (line 1, column 10): the key \"a\"" + remedy);
    EXPECT_NO_THROW(static_cast<void>(parse(R"([{"a": {"a": 1}}, {"a": 2}])")));
    // Among few and many keys, with escapes and without.
    for (const int others : {0, 1, 14, 15, 16, 17, 31, 32, 33, 64, 100}) {
        for (const std::string first : {"a", "\\u0061"}) {
            for (const std::string second : {"a", "\\u0061"}) {
                std::string text = "{\"" + first + "\":0,";
                for (int i = 0; i < others; ++i) text += "\"" + std::to_string(i) + "\":0,";
                EXPECT_NO_THROW(static_cast<void>(parse(text + "\"b\":0}")));
                EXPECT_EQ(fault_of(text + "\"" + second + "\":0}"),
                          "x: /a (line 1, column " + std::to_string(1 + text.size()) +
                              "): the key \"a\"" + remedy);
            }
        }
    }
}

TEST(JsonReader, SaysWhereANumberIsTooLarge) {
    EXPECT_EQ(fault_of(R"({"a": [{"b": 1}, [0, -1e999]]})"),
              "x: /a/1/1 (line 1, column 22): the number \"-1e999\" is not finite as a double; it "
              "must lie within +-1.7976931348623157e308");
    EXPECT_EQ(fault_of("1.7976931348623159e308").substr(0, 36),
              "x: line 1, column 1: the number \"1.7");
}

TEST(JsonReader, RefusesHopelessNesting) {
    const auto nested = [](std::size_t depth) {
        return std::string(depth, '[') + std::string(depth, ']');
    };
    EXPECT_NO_THROW(static_cast<void>(parse(nested(deepest_nesting))));
    EXPECT_EQ(fault_of(nested(deepest_nesting + 1)),
              "x: line 1, column 33: brackets nest deeper than 32 levels; the format needs a few");
    EXPECT_EQ(fault_of(std::string(1'000'000, '[')), fault_of(nested(deepest_nesting + 1)));
    std::string objects;
    for (int i = 0; i < 100'000; ++i) objects += "{\"\":";
    EXPECT_EQ(fault_of(objects),
              "x: line 1, column 129: brackets nest deeper than 32 levels; the format needs a few");
}

TEST(JsonReader, ManyKeysInOneObjectTakeNoQuadraticTime) {
    std::string text = "{";
    for (int i = 0; i < 100'000; ++i) text += "\"" + std::to_string(i) + "\":0,";
    text += "\"7\":0}";
    EXPECT_NE(fault_of(text).find("the key \"7\" stands here for the second time"),
              std::string::npos);
}

TEST(JsonReader, MessagesStayShortAndOnOneLine) {
    std::string escaped;
    for (int i = 0; i < 100'000; ++i) escaped += "\\n";
    for (const std::string& text :
         {"{\"" + escaped + "\": 1, \"" + escaped + "\": 1}", "{\"" + escaped + "\": 1e999}",
          "{\"" + escaped + "\": {", "[\"" + escaped + "\\x", std::string(100'000, '7') + "]",
          "[" + std::string(100'000, 'x')}) {
        EXPECT_LT(fault_of(text).size(), 1000U) << fault_of(text);
    }
    EXPECT_EQ(error_line([] {
                  static_cast<void>(parse_json(SourceText("[", "two\nlines\x1b")));
              }).substr(0, 25),
              "two\\nlines\\x1b: line 1, c");
}

// Four bytes for each value and eight for a list or object, none for what stands between.
TEST(JsonReader, TheIndexIsAsSmallAsItsValuesAreFew) {
    std::string zeros = "[0";
    for (int i = 1; i < 100'000; ++i) zeros += ",0";
    EXPECT_EQ(parse(zeros + "]").index().capacity(), 100'002U);
    EXPECT_EQ(parse(R"( {"a": [1, [], {}], "b": "c d"} )").index().size(), 12U);
    EXPECT_LE(parse(R"({"a": [1, [], {}], "b": "c d"})").index().capacity(), 14U);
}

TEST(JsonReader, LooksAtTheStopOnceInAMegabyteOfAnything) {
    constexpr std::size_t bytes = 8 * bytes_between_looks;
    const auto repeated = [](std::string_view piece) {
        std::string text;
        while (text.size() < bytes) text += piece;
        return text;
    };
    for (const std::string& text :
         {repeated(" ") + "0", "[" + repeated("0,") + "0]", "\"" + repeated("z") + "\"",
          "\"" + repeated("é") + "\"", repeated("0") + "0", "0." + repeated("7"),
          "[" + repeated("[],") + "[]]", "\"" + repeated("\\n") + "\"",
          "[" + repeated(R"({"a":1},)") + "0]"}) {
        std::size_t looks = 0;
        try {
            static_cast<void>(parse_json(SourceText(text, "x"), [&] { ++looks; }));
        } catch (const Error&) {
            // a number of leading zeros
        }
        EXPECT_GE(looks, text.size() / bytes_between_looks) << text.substr(0, 10);
        // In each of the two passes, over the bytes and over the values.
        struct Stopped {};
        for (const std::size_t last : {std::size_t{1}, looks / 2, looks}) {
            std::size_t so_far = 0;
            const auto stop = [&] {
                if (++so_far == last) throw Stopped();
            };
            EXPECT_THROW(static_cast<void>(parse_json(SourceText(text, "x"), stop)), Stopped);
        }
    }
}

TEST(NearestTo, FollowsAPointerAsFarAsItLeads) {
    const std::string_view text = R"({"a/b": [1, {"~": 2}], "": 3})";
    const JsonDocument document = parse(text);
    const auto at = [&](std::string_view pointer) {
        return text.substr(nearest_to(document.root(), pointer).offset(), 2);
    };
    EXPECT_EQ(at(""), "{\"");
    EXPECT_EQ(at("/a~1b/0"), "1,");
    EXPECT_EQ(at("/a~1b/1/~0"), "2}");
    EXPECT_EQ(at("/"), "3}");
    EXPECT_EQ(at("/a~1b/2"), "[1");
    EXPECT_EQ(at("/a~1b/1/missing/0"), "{\"");
    EXPECT_EQ(nearest_to(document.root(), "/missing").offset(), 0U);
    EXPECT_EQ(pointer_into("/x", "a/~b"), "/x/a~1~0b");
}

TEST(JsonReader, AnyTextIsATreeOrAnErrorOfOneLine) {
    const auto seed = std::random_device{}();
    SCOPED_TRACE("seed " + std::to_string(seed));
    std::mt19937 random(seed);
    const std::string_view alphabet =
        "{}[]:,\"\\ueE+-.0123456789truefalsn \n\t\xEF\xBB\xBF\xC3\xA9";
    for (int i = 0; i < 20'000; ++i) {
        std::string text = i % 2 == 0 ? "" : R"({"a": [1, -2.5e3, {"b": "c\u00e9"}], "d": null})";
        for (std::size_t edits = 1 + random() % 20; edits > 0; --edits) {
            const std::size_t at = random() % (text.size() + 1);
            text.insert(at, 1, alphabet[random() % alphabet.size()]);
            if (random() % 2 == 0) text.erase(random() % text.size(), 1);
        }
        try {
            static_cast<void>(parse(text));
        } catch (const Error& error) {
            const std::string_view line = error.what();
            ASSERT_TRUE(line.starts_with("x: ")) << line;
            for (const char c : line) ASSERT_GE(static_cast<unsigned char>(c), 0x20) << line;
        }
    }
}

}  // namespace
}  // namespace ivory
