// Lines of rays and answers: every number reads back to the same double.
#include "core/render/answers_file.h"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <limits>
#include <random>
#include <string>
#include <vector>

#include "tests/error_line.h"

namespace ivory {
namespace {

std::vector<double> doubles() {
    using Limits = std::numeric_limits<double>;
    std::vector<double> values{0.0,
                               -0.0,
                               1,
                               -1,
                               0.1,
                               1e300,
                               -1e-300,
                               Limits::max(),
                               Limits::min(),
                               3e5,
                               0.5,
                               1e22,
                               Limits::denorm_min(),
                               -0x1.8p-1070};
    std::mt19937_64 random(3);
    while (values.size() < 5000) {
        const auto value = std::bit_cast<double>(random());
        if (std::isfinite(value)) values.push_back(value);
    }
    return values;
}

bool same_bits(double a, double b) {
    return std::bit_cast<std::uint64_t>(a) == std::bit_cast<std::uint64_t>(b);
}

TEST(AnswersFile, HexadecimalReadsBackInC) {
    for (const double value : doubles()) {
        std::string text;
        append_hexadecimal(text, value);
        EXPECT_TRUE(same_bits(std::strtod(text.c_str(), nullptr), value)) << text;
        EXPECT_TRUE(text.starts_with("0x") || text.starts_with("-0x")) << text;
    }
}

TEST(AnswersFile, AMissLeavesItsColumnsEmpty) {
    for (const Status status : {Status::miss, Status::claimed_miss}) {
        std::string text;
        append_answer(text, {{status, {}}, {}});
        EXPECT_EQ(text, std::string(status_word(status)) + ",,,,,,,,");
    }
}

TEST(AnswersFile, AnAnswerReadsBackToTheSameDoubles) {
    const std::vector<double> values = doubles();
    for (std::size_t k = 0; k + 8 <= values.size(); k += 8) {
        const double* v = &values[k];
        std::string text;
        append_answer(text,
                      {{Status::hit, {v[0], v[1]}}, {{v[2], v[3], v[4]}, {v[5], v[6], v[7]}}});
        ASSERT_TRUE(text.starts_with("hit,"));
        const char* at = text.c_str() + 3;
        for (int n = 0; n < 8; ++n) {
            ASSERT_EQ(*at, ',') << text;
            char* end = nullptr;
            EXPECT_TRUE(same_bits(std::strtod(at + 1, &end), v[n])) << text;
            at = end;
        }
        EXPECT_EQ(*at, '\0');
    }
}

TEST(AnswersFile, TheColumnsAreAsManyAsTheyAreNamed) {
    const auto commas = [](std::string_view text) {
        return std::count(text.begin(), text.end(), ',');
    };
    std::string hit;
    append_answer(hit, {{Status::unresolved, {1, 2}}, {{0, 0, 1}, {1, 1, 1}}});
    EXPECT_EQ(hit, "unresolved,1,2,0,0,1,1,1,1");
    EXPECT_EQ(commas(hit), commas(answer_columns));
}

TEST(RayLine, ReadsEverySpelling) {
    const Ray expected{{0.5, -2, 3e10}, {0, 1, -0.25}};
    for (const char* line :
         {"0.5 -2 3e10 0 1 -0.25", "0.5,-2,3e10,0,1,-0.25", "  0.5 ,\t-2, 3e10 0 1 , -0.25  ",
          "0x1p-1 -0x1p1 3E+10 0x0p+0 0x1 -0X1P-2", "+.5 -2. 30000000000 0 +1 -.25\r",
          "0.5 -2 3e10 0 1 -0.25# note", "0.5 -2 3e10 0 1 -0.25 # 7 8"}) {
        const auto ray = parse_ray(line);
        ASSERT_TRUE(ray) << line;
        EXPECT_EQ(ray->origin, expected.origin) << line;
        EXPECT_EQ(ray->direction, expected.direction) << line;
    }
}

TEST(RayLine, ReadsBackWhatIsWritten) {
    const std::vector<double> values = doubles();
    for (std::size_t k = 0; k + 6 <= values.size(); k += 6) {
        std::string line;
        for (std::size_t n = 0; n < 6; ++n) {
            append_hexadecimal(line, values[k + n]);
            line += ',';
        }
        line.pop_back();
        const auto ray = parse_ray(line);
        ASSERT_TRUE(ray);
        for (std::size_t axis = 0; axis < 3; ++axis) {
            EXPECT_TRUE(same_bits(ray->origin[axis], values[k + axis])) << line;
            EXPECT_TRUE(same_bits(ray->direction[axis], values[k + 3 + axis])) << line;
        }
    }
}

// Below the least double the nearest one is 0, or the least; that is no fault.
TEST(RayLine, RoundsWhatIsTooSmall) {
    const auto ray = parse_ray("1e-999 -1e-400 3e-324 1 0x1p-1075 0x1.8p-1074");
    ASSERT_TRUE(ray);
    EXPECT_TRUE(same_bits(ray->origin.x, 0.0));
    EXPECT_TRUE(same_bits(ray->origin.y, -0.0));
    EXPECT_EQ(ray->origin.z, std::numeric_limits<double>::denorm_min());
    EXPECT_EQ(ray->direction.y, 0);  // a tie, to even
    EXPECT_EQ(ray->direction.z, 2 * std::numeric_limits<double>::denorm_min());
}

TEST(RayLine, RoundsManyDigitsToNearest) {
    const auto ray = parse_ray(
        "0.1000000000000000055511151231257827021181583404541015625 "
        "0.10000000000000000555111512312578270211815834045410156250000000000000001 "
        "9007199254740993 9007199254740992.99999999999999999999 0x1.00000000000008p0 "
        "0x1.000000000000080000000000000001p0");
    ASSERT_TRUE(ray);
    EXPECT_EQ(ray->origin, (Vec3d{0.1, 0.1, 9007199254740992.0}));
    EXPECT_EQ(ray->direction, (Vec3d{9007199254740992.0, 1.0, 0x1.0000000000001p0}));
}

TEST(RayLine, PassesOverBlankLinesAndComments) {
    for (const char* line : {"", " ", "\t \r", "#", "  # 1 2 3", "#1,2"}) {
        EXPECT_FALSE(parse_ray(line)) << line;
    }
}

TEST(RayLine, SaysWhatIsWrong) {
    struct Case {
        const char* line;
        const char* part;
    };
    for (const Case& wrong :
         {Case{"1 2 3 4 5", "5 numbers where a ray has 6"}, Case{"1", "1 number where"},
          Case{"1 2 3 4 5 6 7 8", "8 numbers"}, Case{"a 2 3 4 5 6", "\"a\" is not a number"},
          Case{"1 2 3 4 5 inf", "not finite"}, Case{"1 2 3 4 5 -nan", "not finite"},
          Case{"1 2 3 4 5 1e309", "not finite"}, Case{"0 0 0 0 0 0", "points nowhere"},
          Case{"1,,2 3 4 5 6", "missing before a comma"},
          Case{"1 2 3 4 5 6,", "missing after a comma"}, Case{"1 2 3 4 5 0x", "is not a number"},
          Case{"1 2 3 4 5 0x-1", "is not a number"}, Case{"1 2 3 4 5 0x0x1", "is not a number"}}) {
        const std::string what =
            tests::error_line([&] { static_cast<void>(parse_ray(wrong.line)); });
        EXPECT_NE(what.find(wrong.part), std::string::npos) << wrong.line << ": " << what;
    }
}

}  // namespace
}  // namespace ivory
