#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <functional>
#include <limits>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/scene/json_reader.h"
#include "core/scene/json_survey.h"
#include "core/scene/json_text.h"
#include "core/scene/text.h"

namespace ivory {
namespace {

using namespace json_text;

// The keys of one object: a few as they are written, where they have no escapes; else all of them as
// offsets, found by what they stand for.
class KeySet {
  public:
    explicit KeySet(std::string_view json) : json_(json) {}

    void clear() {
        few_count_ = 0;
        slots_.clear();
        count_ = 0;
    }

    // False where the key is there already. Its quote stands at `offset`, and it ends before `end`.
    bool insert(std::size_t offset, std::size_t end, bool has_escapes) {
        if (slots_.empty()) {
            if (!has_escapes && few_count_ < most_few) {
                const std::string_view key = json_.substr(offset + 1, end - offset - 1);
                for (std::size_t i = 0; i < few_count_; ++i) {
                    if (few_[i].front() == key.front() && few_[i] == key) return false;
                }
                few_[few_count_++] = key;
                return true;
            }
            for (std::size_t i = 0; i < few_count_; ++i) {
                insert_offset(static_cast<std::size_t>(few_[i].data() - json_.data()) - 1);
            }
        }
        return insert_offset(offset);
    }

  private:
    static constexpr std::size_t most_few = 16;
    static constexpr std::size_t least_slots = 4 * most_few;  // a power of two
    static constexpr std::uint32_t none = std::numeric_limits<std::uint32_t>::max();

    bool insert_offset(std::size_t offset) {
        if (2 * (count_ + 1) > slots_.size()) grow();
        std::string buffer;
        std::uint32_t& slot = slot_of(decoded(json_, offset, buffer));
        if (slot != none) return false;
        slot = static_cast<std::uint32_t>(offset);
        ++count_;
        return true;
    }

    // Where the key is, or is to be put.
    std::uint32_t& slot_of(std::string_view key) {
        const std::size_t mask = slots_.size() - 1;
        std::size_t at = std::hash<std::string_view>()(key) & mask;
        while (slots_[at] != none && decoded(json_, slots_[at], buffer_) != key) {
            at = (at + 1) & mask;
        }
        return slots_[at];
    }

    void grow() {
        const std::vector<std::uint32_t> before = std::exchange(
            slots_, std::vector<std::uint32_t>(std::max(2 * slots_.size(), least_slots), none));
        std::string buffer;
        for (const std::uint32_t offset : before) {
            if (offset != none) slot_of(decoded(json_, offset, buffer)) = offset;
        }
    }

    std::string_view json_;
    // The first `few_count_` of them, each with the quote behind it.
    std::array<std::string_view, most_few> few_;
    std::size_t few_count_ = 0;
    std::vector<std::uint32_t> slots_;  // empty: all keys are in `few_`
    std::size_t count_ = 0;             // of the slots that are not `none`
    std::string buffer_;
};

// What the grammar allows next, as messages say it.
constexpr std::string_view a_value = "'[', '{', or a literal";
constexpr std::string_view a_key = "a key in double quotes";
constexpr std::string_view a_colon = "':'";
constexpr std::string_view more_of_list = "',' or ']'";
constexpr std::string_view more_of_object = "',' or '}'";
constexpr std::string_view the_end = "end of input";

constexpr std::string_view bad_literal = "invalid literal";
constexpr std::string_view bad_escape = "invalid string: forbidden character after backslash";

// One pass from left to right that checks everything and notes where each value stands. What reads
// something takes the place where it begins and answers where it ends: a member of the parser would
// have to be written before each character is read, which for all that a compiler knows is a part
// of it.
class Parser {
  public:
    // Of a text that has no bytes below a blank but line ends and tabs.
    Parser(const SourceText& source, std::size_t most_entries, const Stop& stop)
        : source_(source),
          stop_(stop),
          begin_(source.text().data()),
          end_(begin_ + source.text().size()) {
        index_.reserve(most_entries);
        levels_.reserve(deepest_nesting);
    }

    std::vector<std::uint32_t> parse() {
        const char* at = begin_;
        if (source_.text().starts_with(byte_order_mark)) at += byte_order_mark.size();
        look(at);
        at = skip_space(value(skip_space(at)));
        if (at != end_) unexpected(at, the_end);
        return std::move(index_);
    }

  private:
    struct Level {
        bool is_list;
        std::size_t entry;           // the one that `close` completes
        std::size_t count = 0;       // of the values before the one that is being read
        std::size_t key_offset = 0;  // of its key

        char end() const { return is_list ? ']' : '}'; }
    };

    void look(const char* at) {
        look_at(stop_);
        next_look_ = at + std::min<std::ptrdiff_t>(end_ - at, bytes_between_looks);
    }

    // 0, which stands nowhere in the text, at the end.
    char peek(const char* at) const { return at == end_ ? '\0' : *at; }

    std::size_t offset(const char* at) const { return static_cast<std::size_t>(at - begin_); }

    template <class Wanted>
    const char* skip_while(const char* at, Wanted wanted) {
        while (true) {
            while (at < next_look_ && wanted(*at)) ++at;
            if (at < next_look_ || at == end_) return at;
            look(at);
        }
    }

    const char* skip_space(const char* at) {
        return skip_while(at,
                          [](char c) { return c == ' ' || c == '\n' || c == '\t' || c == '\r'; });
    }

    const char* skip_digits(const char* at) {
        while (next_look_ - at >= eight) {
            const int digits = leading_digits(eight_at(at));
            at += digits;
            if (digits < eight) return at;
        }
        return skip_while(at, is_digit);
    }

    const char* skip_plain(const char* at) {
        while (next_look_ - at >= eight) {
            const int plain = leading_plain(eight_at(at));
            at += plain;
            if (plain < eight) return at;
        }
        return skip_while(at, is_plain_in_text);
    }

    void add_entry(const char* at) { index_.push_back(static_cast<std::uint32_t>(offset(at))); }

    const char* value(const char* at) {
        while (true) {
            if (peek(at) == '[' || peek(at) == '{') {
                at = open(at);
                if (peek(at) != levels_.back().end()) {
                    at = item(at);
                    continue;
                }
                at = close(at);
            } else {
                at = scalar(at);
            }
            while (true) {
                if (levels_.empty()) return at;
                Level& level = levels_.back();
                at = skip_space(at);
                if (peek(at) == ',') {
                    ++level.count;
                    at = item(skip_space(at + 1));
                    break;
                }
                if (peek(at) != level.end()) {
                    unexpected(at, level.is_list ? more_of_list : more_of_object);
                }
                at = close(at);
            }
        }
    }

    // Up to the value of an item of the innermost level.
    const char* item(const char* at) { return levels_.back().is_list ? at : key(at); }

    const char* scalar(const char* at) {
        const char first = peek(at);
        if (first != '-' && !is_digit(first) && first != '"' && first != 't' && first != 'f' &&
            first != 'n') {
            unexpected(at, a_value);
        }
        add_entry(at);
        switch (first) {
            case '"':
                return text(at, a_value);
            case 't':
                return literal(at, "true", a_value);
            case 'f':
                return literal(at, "false", a_value);
            case 'n':
                return literal(at, "null", a_value);
            default:
                return finite_number(at);
        }
    }

    // Passes the bracket.
    const char* open(const char* at) {
        if (levels_.size() == deepest_nesting) {
            throw source_.fault(offset(at), "",
                                "brackets nest deeper than " + std::to_string(deepest_nesting) +
                                    " levels; the format needs a few");
        }
        add_entry(at);
        levels_.push_back({*at == '[', index_.size()});
        index_.push_back(0);
        if (*at == '{') {
            if (keys_.size() < levels_.size()) keys_.resize(levels_.size(), KeySet(source_.text()));
            keys_[levels_.size() - 1].clear();
        }
        return skip_space(at + 1);
    }

    const char* close(const char* at) {
        index_[levels_.back().entry] = static_cast<std::uint32_t>(index_.size());
        levels_.pop_back();
        return at + 1;
    }

    // And what stands between it and its value.
    const char* key(const char* at) {
        if (peek(at) != '"') unexpected(at, a_key);
        add_entry(at);
        const std::size_t start = offset(at);
        at = skip_plain(at + 1);
        const bool is_plain = peek(at) == '"';
        at = is_plain ? at + 1 : rest_of_text(at, a_key);
        if (!keys_[levels_.size() - 1].insert(start, offset(at), !is_plain)) refuse_twin(start);
        levels_.back().key_offset = start;
        at = skip_space(at);
        if (peek(at) != ':') unexpected(at, a_colon);
        return skip_space(at + 1);
    }

    [[noreturn]] void refuse_twin(std::size_t start) const {
        std::string buffer;
        const std::string_view key = decoded(source_.text(), start, buffer);
        throw source_.fault(start, pointer_into(pointer(levels_.size() - 1), key),
                            "the key " + in_quotes(key) +
                                " stands here for the second time in its object; keep one");
    }

    const char* text(const char* at, std::string_view expected) {
        at = skip_plain(at + 1);
        return peek(at) == '"' ? at + 1 : rest_of_text(at, expected);
    }

    // From the first character on that does not stand for itself.
    const char* rest_of_text(const char* at, std::string_view expected) {
        while (true) {
            switch (peek(at)) {
                case '"':
                    return at + 1;
                case '\\':
                    at = escape(at + 1, expected);
                    break;
                case '\n':
                    refuse(at,
                           "invalid string: control character U+000A (LF) must be escaped to "
                           "\\u000A or \\n",
                           expected);
                case '\r':
                    refuse(at,
                           "invalid string: control character U+000D (CR) must be escaped to "
                           "\\u000D or \\r",
                           expected);
                case '\t':
                    refuse(at,
                           "invalid string: control character U+0009 (HT) must be escaped to "
                           "\\u0009 or \\t",
                           expected);
                default:
                    refuse_end();
            }
            at = skip_plain(at);
        }
    }

    // Behind the backslash.
    const char* escape(const char* at, std::string_view expected) {
        constexpr std::string_view letters = "\"\\/bfnrt";
        if (at != end_ && letters.find(*at) != std::string_view::npos) return at + 1;
        if (peek(at) != 'u') refuse(at, bad_escape, expected);
        const unsigned unit = four_digits(++at, expected);
        at += 4;
        if (is_high_surrogate(unit)) {
            constexpr std::string_view alone =
                "invalid string: surrogate U+D800..U+DBFF must be followed by U+DC00..U+DFFF";
            for (const char c : {'\\', 'u'}) {
                if (peek(at) != c) refuse(at, alone, expected);
                ++at;
            }
            const bool is_low = is_low_surrogate(four_digits(at, expected));
            at += 4;
            if (!is_low) refuse(at - 1, alone, expected);
        } else if (is_low_surrogate(unit)) {
            refuse(at - 1, "invalid string: surrogate U+DC00..U+DFFF must follow U+D800..U+DBFF",
                   expected);
        }
        return at;
    }

    unsigned four_digits(const char* at, std::string_view expected) {
        const std::size_t start = offset(at);
        for (int i = 0; i < 4; ++i, ++at) {
            const char c = peek(at);
            if (!is_digit(c) && !(c >= 'a' && c <= 'f') && !(c >= 'A' && c <= 'F')) {
                refuse(at, "invalid string: '\\u' must be followed by 4 hex digits", expected);
            }
        }
        return hexadecimal(source_.text().substr(start, 4));
    }

    const char* literal(const char* at, std::string_view word, std::string_view expected) {
        for (const char c : word) {
            if (peek(at) != c) refuse(at, bad_literal, expected);
            ++at;
        }
        return at;
    }

    const char* finite_number(const char* at) {
        bool may_be_too_large = false;
        const char* const end = number(at, a_value, may_be_too_large);
        if (may_be_too_large) must_be_finite(at, end);
        return end;
    }

    void must_be_finite(const char* at, const char* end) const {
        const std::string_view written(at, static_cast<std::size_t>(end - at));
        if (std::isfinite(number_at(written))) return;
        throw source_.fault(offset(at), pointer(levels_.size()),
                            "the number " + in_quotes(written) +
                                " is not finite as a double; it must lie within "
                                "+-1.7976931348623157e308");
    }

    // Says too whether it may be larger than the largest double.
    const char* number(const char* at, std::string_view expected, bool& may_be_too_large) {
        constexpr std::ptrdiff_t most_harmless_digits = 308;
        const char* const start = at;
        if (*at == '-') ++at;
        at = peek(at) == '0' ? at + 1
                             : digits(at, "invalid number; expected digit after '-'", expected);
        may_be_too_large = at - start > most_harmless_digits;
        if (peek(at) == '.') {
            at = digits(at + 1, "invalid number; expected digit after '.'", expected);
        }
        if (peek(at) != 'e' && peek(at) != 'E') return at;
        may_be_too_large = true;
        ++at;
        if (peek(at) == '+' || peek(at) == '-') {
            return digits(at + 1, "invalid number; expected digit after exponent sign", expected);
        }
        return digits(at, "invalid number; expected '+', '-', or digit after exponent", expected);
    }

    // One at least.
    const char* digits(const char* at, std::string_view without, std::string_view expected) {
        if (!is_digit(peek(at))) refuse(at, without, expected);
        return skip_digits(at);
    }

    // What stands here is not what the grammar allows.
    [[noreturn]] void unexpected(const char* at, std::string_view expected) {
        std::string name;
        const char c = peek(at);
        if (c == '"') {
            at = text(at, expected);
            name = "string literal";
        } else if (c == '-' || is_digit(c)) {
            bool ignored = false;
            at = number(at, expected, ignored);
            name = "number literal";
        } else if (c == 't' || c == 'f' || c == 'n') {
            const std::string word = c == 't' ? "true" : c == 'f' ? "false" : "null";
            at = literal(at, word, expected);
            name = word + " literal";
        } else if (c == '[' || c == ']' || c == '{' || c == '}' || c == ':' || c == ',') {
            ++at;
            name = {'\'', c, '\''};
        } else {
            refuse(at, bad_literal, expected);
        }
        throw syntax_fault(at - 1, "unexpected " + name + "; expected " + std::string(expected));
    }

    // The byte here makes no sense.
    [[noreturn]] void refuse(const char* at, std::string_view what, std::string_view expected) {
        if (at == end_) refuse_end();
        const std::string_view rest = source_.text().substr(offset(at));
        std::size_t bytes = 1;
        while (bytes < rest.size() && !starts_character(rest[bytes])) ++bytes;
        std::string message = std::string(what) + " at " + in_quotes(rest.substr(0, bytes));
        // Text or a number that is wrong in itself may well be the kind of value that is expected.
        if (expected != a_value || what == bad_literal) {
            message += "; expected " + std::string(expected);
        }
        if (expected == a_value && what == bad_escape) {
            message += R"(; expected one of " \ / b f n r t u)";
        }
        throw syntax_fault(at, message);
    }

    [[noreturn]] void refuse_end() {
        throw source_.fault(source_.text().size(), "",
                            levels_.empty()
                                ? std::string("the text ends where a value should stand; it must "
                                              "be one JSON object")
                                : "the text ends inside " + innermost() +
                                      "; close it, or restore the part that was cut off");
    }

    Error syntax_fault(const char* at, const std::string& what) const {
        return source_.fault(offset(at), "", "not JSON: " + what);
    }

    // Of the value that the outermost `count` open levels lead to.
    std::string pointer(std::size_t count) const {
        std::string path, buffer;
        for (std::size_t i = 0; i < count; ++i) {
            path = levels_[i].is_list
                       ? path + "/" + std::to_string(levels_[i].count)
                       : pointer_into(path, decoded(source_.text(), levels_[i].key_offset, buffer));
        }
        return path;
    }

    std::string innermost() const {
        const std::string path = pointer(levels_.size() - 1);
        return (levels_.back().is_list ? "the list " : "the object ") +
               (path.empty() ? std::string("of the top level") : printable(path, 200));
    }

    const SourceText& source_;
    const Stop& stop_;
    const char* const begin_;
    const char* const end_;
    const char* next_look_ = nullptr;
    std::vector<std::uint32_t> index_;
    std::vector<Level> levels_;
    std::vector<KeySet> keys_;  // one for each level, kept for the next object there
};

}  // namespace

JsonDocument parse_json(const SourceText& source, const Stop& stop) {
    constexpr std::size_t most_bytes = std::numeric_limits<std::uint32_t>::max();
    if (source.text().size() >= most_bytes) {
        throw source.fault(0, "", "the text has 4 GiB or more; a scene must be smaller");
    }
    const std::size_t most_entries = most_entries_of(source, stop);
    return {source.text(), Parser(source, most_entries, stop).parse()};
}

}  // namespace ivory
