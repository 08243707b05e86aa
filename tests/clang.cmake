# Toolchain of the preset `clang`: the newest Clang that is installed, under its plain name or a versioned one.
find_program(IVORY_CLANG
    NAMES clang++ clang++-20 clang++-19 clang++-18 clang++-17 clang++-16 clang++-15 clang++-14
    REQUIRED)
set(CMAKE_CXX_COMPILER ${IVORY_CLANG})
