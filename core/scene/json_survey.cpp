#include "core/scene/json_survey.h"

#include <algorithm>
#include <array>
#include <optional>
#include <string>
#include <string_view>

#include "core/scene/json_text.h"
#include "core/scene/text.h"

namespace ivory {
namespace {

using json_text::starts_character;

struct Survey {
    bool plain = true;        // all characters are ASCII, none a control but line ends and tabs
    std::size_t entries = 0;  // at most so many has the text's index
};

constexpr std::size_t survey_block = 64;  // bytes; twice as many fit into one

// No branches and no sums wider than a byte, so that compilers make vectors of it.
template <std::size_t Size>
void survey_bytes(const char* text, Survey& survey) {
    unsigned char odd = 0, entries = 0;
    for (std::size_t i = 0; i < Size; ++i) {
        const auto c = static_cast<unsigned char>(text[i]);
        const auto is = [c](char wanted) { return static_cast<unsigned char>(c == wanted); };
        const auto low = static_cast<unsigned char>(c < 0x20);
        const auto space = static_cast<unsigned char>(is('\n') | is('\t') | is('\r'));
        odd = static_cast<unsigned char>(odd | (c & 0x80) | (low & ~space));
        entries = static_cast<unsigned char>(entries + is(',') + is(':') + is('[') + is('[') +
                                             is('{') + is('{'));
    }
    survey.plain = survey.plain && odd == 0;
    survey.entries += entries;
}

// Each value but the first stands behind one of [ , : and each key behind one of { and , ; lists
// and objects have two entries.
Survey survey(std::string_view text) {
    Survey survey;
    std::size_t at = 0;
    for (; text.size() - at >= survey_block; at += survey_block) {
        survey_bytes<survey_block>(text.data() + at, survey);
    }
    for (; at < text.size(); ++at) survey_bytes<1>(text.data() + at, survey);
    return survey;
}

// Where the piece of the text that begins at `start` ends: between two characters.
std::size_t end_of_piece(std::string_view text, std::size_t start) {
    if (text.size() - start <= bytes_between_looks) return text.size();
    const std::size_t end = start + bytes_between_looks;
    for (std::size_t back = 0; back < 4; ++back) {
        if (starts_character(text[end - back])) return end - back;
    }
    return end;  // behind four bytes that start no character: it is complete or wrong
}

}  // namespace

std::size_t most_entries_of(const SourceText& source, const Stop& stop) {
    const std::string_view text = source.text();
    std::size_t entries = 1;
    std::optional<std::size_t> control;
    for (std::size_t start = 0; start < text.size();) {
        look_at(stop);
        const std::size_t end = end_of_piece(text, start);
        const std::string_view piece = text.substr(start, end - start);
        const Survey found = survey(piece);
        entries += found.entries;
        if (!found.plain) {
            if (const std::optional<std::size_t> at = first_invalid_utf8(piece)) {
                throw source.fault(start + *at, "",
                                   "the byte " + printable(piece.substr(*at, 1)) +
                                       " is not valid UTF-8; save the file as UTF-8 text");
            }
            const auto is_control = [](char c) {
                return static_cast<unsigned char>(c) < 0x20 && c != '\t' && c != '\n' && c != '\r';
            };
            const auto at = std::find_if(piece.begin(), piece.end(), is_control);
            if (!control && at != piece.end()) {
                control = start + static_cast<std::size_t>(at - piece.begin());
            }
        }
        start = end;
    }
    if (control) {
        throw source.fault(*control, "",
                           "the control character " + printable(text.substr(*control, 1)) +
                               " cannot stand in JSON; remove it, or write it as \\u00.. within "
                               "quotes");
    }
    return entries;
}

}  // namespace ivory
