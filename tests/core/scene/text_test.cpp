#include "core/scene/text.h"

#include <gtest/gtest.h>

#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <limits>
#include <random>
#include <string>
#include <string_view>

namespace ivory {
namespace {

using Limits = std::numeric_limits<double>;

std::uint64_t bits(double value) { return std::bit_cast<std::uint64_t>(value); }

TEST(NumberText, ReadsBackToTheSameBits) {
    const auto seed = std::random_device{}();
    SCOPED_TRACE("seed " + std::to_string(seed));
    std::mt19937_64 random(seed);
    for (int i = 0; i < 200'000; ++i) {
        const double any = std::bit_cast<double>(random());
        const double usual = std::ldexp(static_cast<double>(random() >> 40), -12);
        for (const double value : {any, usual, -usual}) {
            if (!std::isfinite(value)) continue;
            const std::string text = number_text(value);
            ASSERT_EQ(bits(std::strtod(text.c_str(), nullptr)), bits(value)) << text;
        }
    }
    for (const double value : {0.0, -0.0, Limits::denorm_min(), -Limits::denorm_min(),
                               Limits::min(), Limits::max(), Limits::lowest(), 0x1p53, 1e16,
                               std::nextafter(1e16, 0.0), 1e-5, std::nextafter(1e-5, 0.0)}) {
        const std::string text = number_text(value);
        EXPECT_EQ(bits(std::strtod(text.c_str(), nullptr)), bits(value)) << text;
    }
}

TEST(NumberText, IsWhatAPersonWouldWrite) {
    EXPECT_EQ(number_text(0), "0");
    EXPECT_EQ(number_text(-0.0), "-0.0");
    EXPECT_EQ(number_text(1), "1");
    EXPECT_EQ(number_text(-0.55), "-0.55");
    EXPECT_EQ(number_text(100000), "100000");
    EXPECT_EQ(number_text(0.00001), "0.00001");
    EXPECT_EQ(number_text(1e22), "1e+22");
    EXPECT_EQ(number_text(5e-324), "5e-324");
    EXPECT_EQ(number_text(Limits::infinity()), "inf");
}

TEST(FirstInvalidUtf8, AcceptsTheEndsOfEachRowOfTheTable) {
    for (const std::string_view text :
         {"", "plain", "\x7F", "\xC2\x80", "\xDF\xBF", "\xE0\xA0\x80", "\xED\x9F\xBF",
          "\xEE\x80\x80", "\xEF\xBF\xBF", "\xF0\x90\x80\x80", "\xF4\x8F\xBF\xBF", "é ∑ 🦣"}) {
        EXPECT_FALSE(first_invalid_utf8(text).has_value()) << printable(text);
    }
}

TEST(FirstInvalidUtf8, FindsTheFirstByteOfEachIllFormedSequence) {
    constexpr std::array<std::string_view, 15> ill_formed = {
        "\x80",              // a continuation alone
        "\xBF",              //
        "\xC0\x80",          // overlong forms
        "\xC1\xBF",          //
        "\xE0\x9F\xBF",      //
        "\xF0\x8F\xBF\xBF",  //
        "\xED\xA0\x80",      // a surrogate
        "\xED\xBF\xBF",      //
        "\xF4\x90\x80\x80",  // beyond U+10FFFF
        "\xF5\x80\x80\x80",  //
        "\xFF",              //
        "\xC3",              // cut off
        "\xE2\x88",          //
        "\xF0\x9F\xA6",      //
        "\xE2\x28\xA1",      // no continuation
    };
    for (const std::string_view bytes : ill_formed) {
        const std::string text = "né" + std::string(bytes);
        EXPECT_EQ(first_invalid_utf8(text), 3U) << printable(text);
        EXPECT_EQ(first_invalid_utf8(text + "x"), 3U) << printable(text);
    }
}

TEST(Printable, LeavesNothingThatBreaksALineOrSteersATerminal) {
    EXPECT_EQ(printable("a b/c.json"), "a b/c.json");
    EXPECT_EQ(printable("é ∑ 🦣"), "é ∑ 🦣");
    EXPECT_EQ(printable("a\nb\rc\td"), "a\\nb\\rc\\td");
    EXPECT_EQ(printable("\x1b[31mred\x7f"), "\\x1b[31mred\\x7f");
    EXPECT_EQ(printable(std::string_view("\0", 1)), "\\x00");
    EXPECT_EQ(printable("caf\xe9"), "caf\\xe9");
    EXPECT_EQ(printable("\xC2\x9B"), "\\u009b");      // CSI in one character
    EXPECT_EQ(printable("\xE2\x80\xA8"), "\\u2028");  // line separator
    EXPECT_EQ(printable("\xE2\x80\xAE"), "\\u202e");  // right-to-left override
    EXPECT_EQ(printable("\xEF\xBB\xBFtext"), "\\ufefftext");
}

TEST(Printable, OfAnyBytesIsValidUtf8WithoutControls) {
    const auto seed = std::random_device{}();
    SCOPED_TRACE("seed " + std::to_string(seed));
    std::mt19937 random(seed);
    for (int i = 0; i < 20'000; ++i) {
        std::string bytes(random() % 12, ' ');
        for (char& byte : bytes) byte = static_cast<char>(random());
        const std::string line = printable(bytes);
        ASSERT_FALSE(first_invalid_utf8(line).has_value()) << line;
        for (const char c : line) ASSERT_GE(static_cast<unsigned char>(c), 0x20) << line;
    }
}

TEST(InQuotes, ShortensWhatIsLong) {
    EXPECT_EQ(in_quotes("tip"), "\"tip\"");
    EXPECT_EQ(in_quotes(std::string(60, 'x')), '"' + std::string(60, 'x') + '"');
    EXPECT_EQ(in_quotes(std::string(61, 'x')), '"' + std::string(60, 'x') + "...\"");
}

TEST(Listed, IsAPhrase) {
    constexpr std::array<std::string_view, 3> words = {"a", "b", "c"};
    EXPECT_EQ(listed({}), "");
    EXPECT_EQ(listed(std::span(words).first(1)), "a");
    EXPECT_EQ(listed(std::span(words).first(2)), "a and b");
    EXPECT_EQ(listed(words, "or"), "a, b or c");
}

TEST(NearestWord, IsWhatWasMeantOrNothing) {
    constexpr std::array<std::string_view, 5> words = {"a", "color", "width", "threshold", "up"};
    EXPECT_EQ(nearest_word("colour", words), "color");
    EXPECT_EQ(nearest_word("Width", words), "width");
    EXPECT_EQ(nearest_word("treshhold", words), "threshold");
    EXPECT_EQ(nearest_word("b", words), std::nullopt);
    EXPECT_EQ(nearest_word("radius", words), std::nullopt);
    EXPECT_EQ(nearest_word("", words), std::nullopt);
    EXPECT_EQ(nearest_word(std::string(1'000'000, 'w'), words), std::nullopt);
}

}  // namespace
}  // namespace ivory
