// tests/tools/interval_calculator as an outside suite would use it: lines in, lines out.
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>
#include <utility>
#include <vector>

namespace ivory::test {
namespace {

struct Outcome {
    int exit_status;
    std::string output;
    std::string error;
};

std::string contents(const std::filesystem::path& file) {
    std::ifstream stream(file);
    return {std::istreambuf_iterator<char>(stream), {}};
}

Outcome calculate(const std::string& input) {
    const std::filesystem::path folder = std::filesystem::path(testing::TempDir()) /
                                         ("ivory_calculator_" + std::to_string(getpid()));
    std::filesystem::create_directories(folder);
    std::ofstream(folder / "in") << input;
    const std::string at = "'" + folder.string() + "/";
    const std::string command = std::string("'") + IVORY_INTERVAL_CALCULATOR + "' < " + at +
                                "in' > " + at + "out' 2> " + at + "err'";
    const int status = std::system(command.c_str());
    Outcome outcome{WEXITSTATUS(status), contents(folder / "out"), contents(folder / "err")};
    std::filesystem::remove_all(folder);
    return outcome;
}

TEST(IntervalCalculator, AnswersEveryOperation) {
    const std::vector<std::pair<std::string, std::string>> table{
        {"add,0x1p+0:0x1p+1;1:2", "0x1p+1,0x1p+2"},
        {"sub,1:2;3:4", "-0x1.8p+1,-0x1p+0"},
        {"mul,-2:3;-5:7", "-0x1.ep+3,0x1.5p+4"},
        {"mul,0:0;-inf:inf", "0x0p+0,0x0p+0"},
        {"div,1:1;0:1", "0x1p+0,inf"},
        {"div,1:2;0:0", "empty"},
        {"recip,-1:1", "-inf,inf"},
        {"neg,1:inf", "-inf,-0x1p+0"},
        {"sqr,-3:2", "0x0p+0,0x1.2p+3"},
        {"sqrt,-4:9", "0x0p+0,0x1.8p+1"},
        {"sqrt,-4:-1", "empty"},
        {"exp,-inf:0", "0x0p+0,0x1p+0"},
        {"exp,1e9:1e10", "0x1.fffffffffffffp+1023,inf"},
        {"pown,-3:2;3", "-0x1.bp+4,0x1p+3"},
        {"pown,2:4;-2", "0x1p-4,0x1p-2"},
        {"fma,2:3;4:5;1", "0x1.2p+3,0x1p+4"},
        {"hull,1:2;empty", "0x1p+0,0x1p+1"},
        {"intersection,1:2;3:4", "empty"},
        {"min,1:4;2:3", "0x1p+0,0x1.8p+1"},
        {"max,1:4;2:3", "0x1p+1,0x1p+2"},
        {"abs,-3:2", "0x0p+0,0x1.8p+1"},
        {"mid,1:2", "0x1.8p+0,0x1.8p+0"},
        {"mid,-inf:inf", "0x0p+0,0x0p+0"},
        {"mid,empty", "nan,nan"},
        {"rad,1:inf", "inf,inf"},
        {"wid,1:3", "0x1p+1,0x1p+1"},
        {"mag,-3:2", "0x1.8p+1,0x1.8p+1"},
        {"mig,-3:-2", "0x1p+1,0x1p+1"},
        {"cosh,1:2", "skip"},
        {"add,empty;1:2", "empty"},
    };
    std::string input, expected;
    for (const auto& [line, answer] : table) {
        input += line + '\n';
        expected += answer + '\n';
    }
    const Outcome outcome = calculate(input);
    EXPECT_EQ(outcome.exit_status, 0);
    EXPECT_EQ(outcome.output, expected);
    EXPECT_EQ(outcome.error, "");
}

TEST(IntervalCalculator, RefusesAMalformedLineInOneLine) {
    for (const char* line :
         {"", "add", ",1:2", "add,1:2", "add,1:2;3:4;5:6", "add,1:2;", "neg,2:1", "neg,a:b",
          "neg,1:", "neg,:1", "neg,1:2:3", "neg,nan:nan", "neg,inf:inf", "neg, 1:2", "neg,1:2x",
          "pown,1:2;2.5", "pown,1:2;99999999999", "pown,1:2;3:4"}) {
        const Outcome outcome = calculate("neg,1:2\n" + std::string(line) + "\nneg,1:2\n");
        EXPECT_EQ(outcome.exit_status, 1) << line;
        EXPECT_EQ(outcome.output, "-0x1p+1,-0x1p+0\n") << line;
        EXPECT_EQ(outcome.error.find("interval_calculator: line 2: "), 0U) << outcome.error;
        EXPECT_EQ(outcome.error.find('\n'), outcome.error.size() - 1) << outcome.error;
    }
}

}  // namespace
}  // namespace ivory::test
