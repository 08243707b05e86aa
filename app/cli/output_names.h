// What may stand where a call names a file to write: a suffix that says what is written, and no
// file that the call reads or names for something else.
#pragma once

#include <span>
#include <string>
#include <string_view>

namespace ivory {

struct NamedFile {
    std::string_view option;                     // what the user calls it: "--depth"
    std::string path;                            // "-": standard input or output; empty: not named
    std::span<const std::string_view> suffixes;  // of an output: those that say what is in it
};

// Throws UsageError for an output with another suffix (case does not matter; standard output,
// devices and pipes need none), for two inputs or two outputs that are the same file, and Error for
// an output that is one of the inputs. Files are compared, not names: links and other spellings
// count as the same. A device as /dev/null may be named for several outputs. Outputs without
// `suffixes` may have any.
void check_files(std::span<const NamedFile> inputs, std::span<const NamedFile> outputs);

}  // namespace ivory
