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

// The keys of one object, as offsets into its text.
class KeySet {
  public:
    explicit KeySet(std::string_view json) : json_(json) {}

    void clear() {
        slots_.assign(least_slots, none);
        count_ = 0;
    }

    // False where the key is there already. `key` is what the text at `offset` stands for.
    bool insert(std::string_view key, std::size_t offset) {
        if (2 * (count_ + 1) > slots_.size()) grow();
        std::uint32_t& slot = slot_of(key);
        if (slot != none) return false;
        slot = static_cast<std::uint32_t>(offset);
        ++count_;
        return true;
    }

  private:
    static constexpr std::size_t least_slots = 16;  // a power of two
    static constexpr std::uint32_t none = std::numeric_limits<std::uint32_t>::max();

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
    std::vector<std::uint32_t> slots_;
    std::size_t count_ = 0;
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

// One pass from left to right that checks everything and notes where each value stands.
class Parser {
  public:
    // Of a text that has no bytes below a blank but line ends and tabs.
    Parser(const SourceText& source, std::size_t most_entries, const Stop& stop)
        : source_(source),
          stop_(stop),
          at_(source.text().data()),
          next_look_(at_),
          end_(at_ + source.text().size()) {
        index_.reserve(most_entries);
        levels_.reserve(deepest_nesting);
        if (source.text().starts_with(byte_order_mark)) at_ += byte_order_mark.size();
        look();
    }

    std::vector<std::uint32_t> parse() {
        skip_space();
        value();
        skip_space();
        if (at_ != end_) unexpected(the_end);
        return std::move(index_);
    }

  private:
    struct Level {
        bool is_list;
        std::size_t count = 0;       // of the values before the one that is being read
        std::size_t key_offset = 0;  // of its key
    };

    void look() {
        look_at(stop_);
        next_look_ = at_ + std::min<std::ptrdiff_t>(end_ - at_, bytes_between_looks);
    }

    // 0, which stands nowhere in the text, at the end.
    char peek() const { return at_ == end_ ? '\0' : *at_; }

    std::size_t offset() const { return static_cast<std::size_t>(at_ - source_.text().data()); }

    template <class Wanted>
    void skip_while(Wanted wanted) {
        while (true) {
            while (at_ < next_look_ && wanted(*at_)) ++at_;
            if (at_ < next_look_ || at_ == end_) return;
            look();
        }
    }

    void skip_space() {
        skip_while([](char c) { return c == ' ' || c == '\n' || c == '\t' || c == '\r'; });
    }

    void add_entry() { index_.push_back(static_cast<std::uint32_t>(offset())); }

    void value() {
        switch (peek()) {
            case '{':
                return object();
            case '[':
                return list();
            case '"':
                add_entry();
                return text(a_value);
            case 't':
                add_entry();
                return literal("true", a_value);
            case 'f':
                add_entry();
                return literal("false", a_value);
            case 'n':
                add_entry();
                return literal("null", a_value);
            default:
                if (peek() != '-' && !is_digit(peek())) unexpected(a_value);
                add_entry();
                return finite_number();
        }
    }

    void list() {
        const std::size_t entry = open(true);
        if (peek() != ']') {
            while (true) {
                value();
                ++levels_.back().count;
                skip_space();
                if (peek() != ',') break;
                ++at_;
                skip_space();
            }
            if (peek() != ']') unexpected(more_of_list);
        }
        close(entry);
    }

    void object() {
        const std::size_t entry = open(false);
        if (peek() != '}') {
            while (true) {
                if (peek() != '"') unexpected(a_key);
                key();
                skip_space();
                if (peek() != ':') unexpected(a_colon);
                ++at_;
                skip_space();
                value();
                skip_space();
                if (peek() != ',') break;
                ++at_;
                skip_space();
            }
            if (peek() != '}') unexpected(more_of_object);
        }
        close(entry);
    }

    // Passes the bracket; the entry that `close` completes.
    std::size_t open(bool is_list) {
        if (levels_.size() == deepest_nesting) {
            throw source_.fault(offset(), "",
                                "brackets nest deeper than " + std::to_string(deepest_nesting) +
                                    " levels; the format needs a few");
        }
        levels_.push_back({is_list});
        if (!is_list) {
            if (keys_.size() < levels_.size()) keys_.resize(levels_.size(), KeySet(source_.text()));
            keys_[levels_.size() - 1].clear();
        }
        add_entry();
        index_.push_back(0);
        ++at_;
        skip_space();
        return index_.size() - 1;
    }

    void close(std::size_t entry) {
        index_[entry] = static_cast<std::uint32_t>(index_.size());
        levels_.pop_back();
        ++at_;
    }

    void key() {
        const std::size_t start = offset();
        add_entry();
        text(a_key);
        const std::string_view key = decoded(source_.text(), start, buffer_);
        if (!keys_[levels_.size() - 1].insert(key, start)) {
            throw source_.fault(start, pointer_into(pointer(levels_.size() - 1), key),
                                "the key " + in_quotes(key) +
                                    " stands here for the second time in its object; keep one");
        }
        levels_.back().key_offset = start;
    }

    void text(std::string_view expected) {
        ++at_;
        while (true) {
            skip_while(is_plain_in_text);
            switch (peek()) {
                case '"':
                    ++at_;
                    return;
                case '\\':
                    ++at_;
                    escape(expected);
                    break;
                case '\n':
                    refuse(
                        "invalid string: control character U+000A (LF) must be escaped to "
                        "\\u000A or \\n",
                        expected);
                case '\r':
                    refuse(
                        "invalid string: control character U+000D (CR) must be escaped to "
                        "\\u000D or \\r",
                        expected);
                case '\t':
                    refuse(
                        "invalid string: control character U+0009 (HT) must be escaped to "
                        "\\u0009 or \\t",
                        expected);
                default:
                    refuse_end();
            }
        }
    }

    void escape(std::string_view expected) {
        constexpr std::string_view letters = "\"\\/bfnrt";
        if (at_ != end_ && letters.find(*at_) != std::string_view::npos) {
            ++at_;
            return;
        }
        if (peek() != 'u') refuse(bad_escape, expected);
        ++at_;
        const unsigned unit = four_digits(expected);
        if (is_high_surrogate(unit)) {
            constexpr std::string_view alone =
                "invalid string: surrogate U+D800..U+DBFF must be followed by U+DC00..U+DFFF";
            for (const char c : {'\\', 'u'}) {
                if (peek() != c) refuse(alone, expected);
                ++at_;
            }
            if (!is_low_surrogate(four_digits(expected))) refuse_last(alone, expected);
        } else if (is_low_surrogate(unit)) {
            refuse_last("invalid string: surrogate U+DC00..U+DFFF must follow U+D800..U+DBFF",
                        expected);
        }
    }

    unsigned four_digits(std::string_view expected) {
        const std::size_t start = offset();
        for (int i = 0; i < 4; ++i) {
            const char c = peek();
            if (!is_digit(c) && !(c >= 'a' && c <= 'f') && !(c >= 'A' && c <= 'F')) {
                refuse("invalid string: '\\u' must be followed by 4 hex digits", expected);
            }
            ++at_;
        }
        return hexadecimal(source_.text().substr(start, 4));
    }

    void literal(std::string_view word, std::string_view expected) {
        for (const char c : word) {
            if (peek() != c) refuse(bad_literal, expected);
            ++at_;
        }
    }

    void finite_number() {
        const std::size_t start = offset();
        if (!number(a_value)) return;
        const std::string_view written = source_.text().substr(start, offset() - start);
        if (std::isfinite(number_at(written))) return;
        throw source_.fault(start, pointer(levels_.size()),
                            "the number " + in_quotes(written) +
                                " is not finite as a double; it must lie within "
                                "+-1.7976931348623157e308");
    }

    // Whether it may be larger than the largest double.
    bool number(std::string_view expected) {
        constexpr std::ptrdiff_t most_harmless_digits = 308;
        const char* const start = at_;
        if (*at_ == '-') ++at_;
        if (peek() == '0') {
            ++at_;
        } else {
            digits("invalid number; expected digit after '-'", expected);
        }
        const bool is_long = at_ - start > most_harmless_digits;
        if (peek() == '.') {
            ++at_;
            digits("invalid number; expected digit after '.'", expected);
        }
        if (peek() != 'e' && peek() != 'E') return is_long;
        ++at_;
        if (peek() == '+' || peek() == '-') {
            ++at_;
            digits("invalid number; expected digit after exponent sign", expected);
        } else {
            digits("invalid number; expected '+', '-', or digit after exponent", expected);
        }
        return true;
    }

    // One at least.
    void digits(std::string_view without, std::string_view expected) {
        if (!is_digit(peek())) refuse(without, expected);
        skip_while(is_digit);
    }

    // What stands here is not what the grammar allows.
    [[noreturn]] void unexpected(std::string_view expected) {
        std::string name;
        const char c = peek();
        if (c == '"') {
            text(expected);
            name = "string literal";
        } else if (c == '-' || is_digit(c)) {
            number(expected);
            name = "number literal";
        } else if (c == 't' || c == 'f' || c == 'n') {
            const std::string word = c == 't' ? "true" : c == 'f' ? "false" : "null";
            literal(word, expected);
            name = word + " literal";
        } else if (c == '[' || c == ']' || c == '{' || c == '}' || c == ':' || c == ',') {
            ++at_;
            name = {'\'', c, '\''};
        } else {
            refuse(bad_literal, expected);
        }
        --at_;
        throw syntax_fault("unexpected " + name + "; expected " + std::string(expected));
    }

    // The byte here makes no sense.
    [[noreturn]] void refuse(std::string_view what, std::string_view expected) {
        if (at_ == end_) refuse_end();
        const std::string_view rest = source_.text().substr(offset());
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
        throw syntax_fault(message);
    }

    // The byte before makes no sense.
    [[noreturn]] void refuse_last(std::string_view what, std::string_view expected) {
        --at_;
        refuse(what, expected);
    }

    [[noreturn]] void refuse_end() {
        throw source_.fault(source_.text().size(), "",
                            levels_.empty()
                                ? std::string("the text ends where a value should stand; it must "
                                              "be one JSON object")
                                : "the text ends inside " + innermost() +
                                      "; close it, or restore the part that was cut off");
    }

    Error syntax_fault(const std::string& what) const {
        return source_.fault(offset(), "", "not JSON: " + what);
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
    const char* at_;
    const char* next_look_;
    const char* end_;
    std::vector<std::uint32_t> index_;
    std::vector<Level> levels_;
    std::vector<KeySet> keys_;  // one for each level, kept for the next object there
    std::string buffer_;
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
