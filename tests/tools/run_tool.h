// What the main functions of the tools have in common.
#pragma once

#include <cstdio>
#include <exception>

namespace ivory::tools {

// run(argc, argv), and 1 with one line on standard error for what it throws.
inline int run_tool(const char* name, int (*run)(int, char**), int argc, char** argv) {
    try {
        return run(argc, argv);
    } catch (const std::exception& error) {
        std::fprintf(stderr, "%s: %s\n", name, error.what());
        return 1;
    }
}

}  // namespace ivory::tools
