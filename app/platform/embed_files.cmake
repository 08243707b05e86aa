# Writes a source file that defines embedded_file() of app/platform/embedded.h.
# cmake -DROOT=... -DFILES="a;b" -DOUTPUT=x.cpp -P embed_files.cmake
set(arrays "")
set(branches "")
set(index 0)
foreach(path IN LISTS FILES)
    file(READ "${ROOT}/${path}" bytes HEX)
    string(REGEX REPLACE "(..)" "0x\\1," bytes "${bytes}")
    string(APPEND arrays "constexpr unsigned char file_${index}[] = {${bytes}0};\n")
    string(APPEND branches
        "    if (path == \"${path}\")\n"
        "        return {reinterpret_cast<const char*>(file_${index}), sizeof file_${index} - 1};\n")
    math(EXPR index "${index} + 1")
endforeach()
file(WRITE "${OUTPUT}" "#include \"app/platform/embedded.h\"

#include <stdexcept>
#include <string>

namespace ivory {

namespace {

${arrays}
}  // namespace

std::string_view embedded_file(std::string_view path) {
${branches}    throw std::logic_error(\"not embedded: \" + std::string(path));
}

}  // namespace ivory
")
