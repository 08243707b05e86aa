#include "app/cli/output_names.h"

#include <algorithm>
#include <cstddef>
#include <filesystem>

#include "app/cli/arguments.h"
#include "core/scene/error.h"
#include "core/scene/text.h"
#include "core/scene/write_file.h"

namespace ivory {
namespace {

bool same_file(const NamedFile& a, FileUse use_a, const NamedFile& b, FileUse use_b) {
    if (a.path.empty() || b.path.empty()) return false;
    if (a.path == "-" && b.path == "-" && use_a == use_b) return true;
    const auto identity = file_identity(a.path, use_a);
    return identity && identity == file_identity(b.path, use_b);
}

std::string label_of(const NamedFile& output) {
    return output.path == "-" ? "standard output" : printable(output.path);
}

void check_suffix(const NamedFile& output) {
    if (output.path.empty() || output.path == "-" || is_written_straight(output.path)) return;
    std::string suffix = std::filesystem::path(output.path).extension().string();
    for (char& c : suffix) c = c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
    if (std::find(output.suffixes.begin(), output.suffixes.end(), suffix) !=
        output.suffixes.end()) {
        return;
    }
    throw UsageError(std::string(output.option) + ": " + in_quotes(output.path) +
                     (suffix.empty()
                          ? " has no suffix"
                          : " has the suffix " + in_quotes(suffix) + ", which is not written") +
                     "; name a file that ends in " + listed(output.suffixes, "or"));
}

}  // namespace

void check_files(std::span<const NamedFile> inputs, std::span<const NamedFile> outputs) {
    for (std::size_t b = 0; b < inputs.size(); ++b) {
        for (std::size_t a = 0; a < b; ++a) {
            if (!same_file(inputs[a], FileUse::input, inputs[b], FileUse::input)) continue;
            const std::string both =
                std::string(inputs[a].option) + " and " + std::string(inputs[b].option);
            throw UsageError(inputs[b].path == "-" ? "standard input cannot be " + both +
                                                         " at once; name a file for one of them"
                                                   : printable(inputs[b].path) + " is named for " +
                                                         both + "; name another for one of them");
        }
    }
    for (std::size_t b = 0; b < outputs.size(); ++b) {
        for (std::size_t a = 0; a < b; ++a) {
            if (!same_file(outputs[a], FileUse::output, outputs[b], FileUse::output)) continue;
            throw UsageError(label_of(outputs[b]) + " is named for two outputs, " +
                             std::string(outputs[a].option) + " and " +
                             std::string(outputs[b].option) + "; name another for one of them");
        }
        for (const NamedFile& input : inputs) {
            if (!same_file(input, FileUse::input, outputs[b], FileUse::output)) continue;
            throw Error(label_of(outputs[b]) + ": is " + std::string(input.option) +
                        " itself; name another file to write to");
        }
    }
    for (const NamedFile& output : outputs) {
        if (!output.suffixes.empty()) check_suffix(output);
    }
}

}  // namespace ivory
