#include "core/scene/json_reader.h"

#include <gtest/gtest.h>

#include <bit>
#include <clocale>
#include <cmath>
#include <cstdint>
#include <random>
#include <string>
#include <string_view>

#include "tests/error_line.h"

namespace ivory {
namespace {

using tests::error_line;

JsonValue parse(std::string_view text) { return parse_json(SourceText(text, "x")); }

std::string fault_of(std::string_view text) {
    return error_line([&] { static_cast<void>(parse(text)); });
}

double number(const std::string& text) {
    return std::get<double>(
        std::get<JsonValue::Array>(parse("[" + text + "]").content).at(0).content);
}

TEST(JsonReader, KeepsEveryKindOfValue) {
    const JsonValue root = parse(R"({"z": null, "a": [true, false, "é\n\u00e9", -1.5], "o": {}})");
    const auto& members = std::get<JsonValue::Object>(root.content);
    ASSERT_EQ(members.size(), 3U);
    EXPECT_EQ(members[0].key, "z");  // in file order
    EXPECT_TRUE(std::holds_alternative<std::nullptr_t>(members[0].value.content));
    const auto& items = std::get<JsonValue::Array>(members[1].value.content);
    EXPECT_TRUE(std::get<bool>(items.at(0).content));
    EXPECT_FALSE(std::get<bool>(items.at(1).content));
    EXPECT_EQ(std::get<std::string>(items.at(2).content), "é\né");
    EXPECT_EQ(std::get<double>(items.at(3).content), -1.5);
    EXPECT_TRUE(std::get<JsonValue::Object>(members[2].value.content).empty());
    EXPECT_EQ(find_member(members, "o"), &members[2].value);
    EXPECT_EQ(find_member(members, "p"), nullptr);
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
    const JsonValue root = parse(text);
    const auto from = [&](const JsonValue& value) { return text.substr(value.offset); };
    EXPECT_EQ(root.offset, 1U);
    const auto& members = std::get<JsonValue::Object>(root.content);
    EXPECT_TRUE(text.substr(members[0].offset).starts_with("\"a\\\"b\" :"));
    EXPECT_TRUE(from(members[0].value).starts_with("[ 10"));
    const auto& items = std::get<JsonValue::Array>(members[0].value.content);
    EXPECT_TRUE(from(items.at(0)).starts_with("10 ,"));
    EXPECT_TRUE(from(items.at(1)).starts_with("-2.5,"));
    EXPECT_TRUE(from(items.at(2)).starts_with("{\"c\""));
    EXPECT_TRUE(
        from(std::get<JsonValue::Object>(items.at(2).content)[0].value).starts_with("true"));
    EXPECT_TRUE(text.substr(members[1].offset).starts_with("\"d\""));
    EXPECT_TRUE(from(members[1].value).starts_with("\"]\""));
}

TEST(JsonReader, CountsColumnsInCharactersAndPassesOverAByteOrderMark) {
    EXPECT_EQ(fault_of("[\n \"é∑🦣\", x]"),
              "x: line 2, column 9: not JSON: invalid literal at \"x\"; expected '[', '{', or a "
              "literal");
    EXPECT_EQ(parse("\xEF\xBB\xBF[1]").offset, 3U);
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

TEST(NearestTo, FollowsAPointerAsFarAsItLeads) {
    const std::string_view text = R"({"a/b": [1, {"~": 2}], "": 3})";
    const JsonValue root = parse(text);
    const auto at = [&](std::string_view pointer) {
        return text.substr(nearest_to(root, pointer).offset, 2);
    };
    EXPECT_EQ(at(""), "{\"");
    EXPECT_EQ(at("/a~1b/0"), "1,");
    EXPECT_EQ(at("/a~1b/1/~0"), "2}");
    EXPECT_EQ(at("/"), "3}");
    EXPECT_EQ(at("/a~1b/2"), "[1");
    EXPECT_EQ(at("/a~1b/1/missing/0"), "{\"");
    EXPECT_EQ(nearest_to(root, "/missing").offset, 0U);
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
