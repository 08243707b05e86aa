#include "app/panels/shown_text.h"

#include <imgui.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cstddef>
#include <cstdio>
#include <string_view>
#include <system_error>

namespace ivory {

namespace {

struct Character {
    char32_t code = 0;
    std::size_t length = 1;  // bytes
};

// That begins at `at` of well-formed UTF-8; anything else is read byte by byte.
Character character_at(std::string_view text, std::size_t at) {
    const auto byte = [&](std::size_t i) {
        return at + i < text.size() ? static_cast<unsigned char>(text[at + i]) : 0u;
    };
    const unsigned first = byte(0);
    const std::size_t length = first >= 0xF0 ? 4 : first >= 0xE0 ? 3 : first >= 0xC0 ? 2 : 1;
    if (length == 1) return {first, 1};
    char32_t code = first & (0x7Fu >> length);
    for (std::size_t i = 1; i < length; ++i) code = (code << 6) | (byte(i) & 0x3Fu);
    return {code, std::min(length, text.size() - at)};
}

void append_utf8(std::string& text, char32_t code) {
    const auto add = [&](char32_t byte) { text += static_cast<char>(byte); };
    if (code < 0x800) {
        add(0xC0 | (code >> 6));
    } else if (code < 0x10000) {
        add(0xE0 | (code >> 12));
        add(0x80 | ((code >> 6) & 0x3F));
    } else {
        add(0xF0 | (code >> 18));
        add(0x80 | ((code >> 12) & 0x3F));
        add(0x80 | ((code >> 6) & 0x3F));
    }
    add(0x80 | (code & 0x3F));
}

}  // namespace

std::string shown_text(const ViewerState& state, const std::string& text) {
    std::string shown;
    for (std::size_t at = 0; at < text.size();) {
        const auto [character, length] = character_at(text, at);
        if (character < 0x80 || state.fonts.have(character)) {
            shown.append(text, at, length);
        } else {
            std::array<char, 16> escaped{};
            std::snprintf(escaped.data(), escaped.size(), "\\u{%04X}",
                          static_cast<unsigned>(character));
            shown += escaped.data();
        }
        at += length;
    }
    return shown;
}

std::string meant_text(const std::string& shown) {
    constexpr std::string_view opening = "\\u{";
    std::string text;
    for (std::size_t at = 0; at < shown.size();) {
        const std::size_t end = shown.find('}', at);
        unsigned number = 0;
        if (shown.compare(at, opening.size(), opening) == 0 && end != std::string::npos) {
            const char* const begin = shown.data() + at + opening.size();
            const auto [rest, error] = std::from_chars(begin, shown.data() + end, number, 16);
            const bool surrogate = number >= 0xD800 && number < 0xE000;
            if (error == std::errc() && rest == shown.data() + end && number >= 0x80 &&
                number <= 0x10FFFF && !surrogate) {
                append_utf8(text, number);
                at = end + 1;
                continue;
            }
        }
        text += shown[at++];
    }
    return text;
}

void want_glyphs(ViewerState& state, const std::string& text) {
    constexpr std::size_t most_glyphs = 3'000;
    for (std::size_t at = 0; at < text.size();) {
        const auto [character, length] = character_at(text, at);
        if (character >= 0x80 && character <= 0xFFFF && state.glyphs.size() < most_glyphs)
            state.glyphs.insert(static_cast<char16_t>(character));
        at += length;
    }
}

std::string fitted_text(const std::string& text, float width) {
    if (ImGui::CalcTextSize(text.c_str()).x <= width) return text;
    const std::string ellipsis = "\xE2\x80\xA6";
    const float room = width - ImGui::CalcTextSize(ellipsis.c_str()).x;
    const char* end = text.c_str();
    ImGui::GetFont()->CalcTextSizeA(ImGui::GetFontSize(), std::max(room, 0.0f), 0, text.c_str(),
                                    text.c_str() + text.size(), &end);
    return std::string(text.c_str(), end) + ellipsis;
}

}  // namespace ivory
