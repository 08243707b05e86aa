#include "core/scene/json_reader.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <functional>
#include <limits>
#include <system_error>
#include <utility>

#include "core/scene/text.h"

namespace ivory {
namespace {

constexpr std::string_view byte_order_mark = "\xEF\xBB\xBF";

// In well-formed UTF-8.
bool starts_character(char c) { return (static_cast<unsigned char>(c) & 0xC0) != 0x80; }

bool is_digit(char c) { return c >= '0' && c <= '9'; }

bool is_plain_in_text(char c) {
    return c != '"' && c != '\\' && static_cast<unsigned char>(c) >= 0x20;
}

unsigned hexadecimal(std::string_view digits) {
    unsigned value = 0;
    std::from_chars(digits.data(), digits.data() + digits.size(), value, 16);
    return value;
}

bool is_high_surrogate(unsigned unit) { return unit >= 0xD800 && unit < 0xDC00; }
bool is_low_surrogate(unsigned unit) { return unit >= 0xDC00 && unit < 0xE000; }

void append_utf8(std::string& text, unsigned code_point) {
    const auto append = [&](unsigned byte) { text += static_cast<char>(byte); };
    const auto append_rest = [&](unsigned shift) { append(0x80 | (code_point >> shift & 0x3F)); };
    if (code_point < 0x80) {
        append(code_point);
    } else if (code_point < 0x800) {
        append(0xC0 | code_point >> 6);
        append_rest(0);
    } else if (code_point < 0x10000) {
        append(0xE0 | code_point >> 12);
        append_rest(6);
        append_rest(0);
    } else {
        append(0xF0 | code_point >> 18);
        append_rest(12);
        append_rest(6);
        append_rest(0);
    }
}

// What the text whose quote stands at `offset` stands for: a part of `json`, or of `buffer` where
// there are escapes. Of JSON that has been found right.
std::string_view decoded(std::string_view json, std::size_t offset, std::string& buffer) {
    const std::size_t start = offset + 1;
    std::size_t at = start;
    while (is_plain_in_text(json[at])) ++at;
    if (json[at] == '"') return json.substr(start, at - start);

    buffer.assign(json.substr(start, at - start));
    while (json[at] != '"') {
        if (json[at] != '\\') {
            buffer += json[at++];
            continue;
        }
        constexpr std::string_view letters = "bfnrt", meant = "\b\f\n\r\t";
        const char escaped = json[at + 1];
        at += 2;
        if (escaped == 'u') {
            unsigned code_point = hexadecimal(json.substr(at, 4));
            at += 4;
            if (is_high_surrogate(code_point)) {
                const unsigned low = hexadecimal(json.substr(at + 2, 4));
                code_point = 0x10000 + ((code_point - 0xD800) << 10) + (low - 0xDC00);
                at += 6;
            }
            append_utf8(buffer, code_point);
        } else {
            const std::size_t letter = letters.find(escaped);
            buffer += letter == std::string_view::npos ? escaped : meant[letter];
        }
    }
    return buffer;
}

// Infinite beyond the largest double. `text` begins with a number as JSON writes it.
double number_at(std::string_view text) {
    double value = 0;
    const auto read = std::from_chars(text.data(), text.data() + text.size(), value);
    if (read.ec != std::errc::result_out_of_range) return value;
    return rounded(std::string(text.data(), read.ptr));
}

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

// The most entries that the text's index can have. Refuses bytes that stand in no text.
std::size_t survey_and_refuse(const SourceText& source, const Stop& stop) {
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

}  // namespace

SourceText::SourceText(std::string_view text, std::string_view name)
    : text_(text), name_(printable(name)) {}

Error SourceText::fault(std::size_t offset, std::string_view pointer,
                        std::string_view message) const {
    std::string_view before = text_.substr(0, offset);
    const auto line = 1 + std::count(before.begin(), before.end(), '\n');
    // Without '\n' rfind answers npos, and npos + 1 is 0.
    before.remove_prefix(before.rfind('\n') + 1);
    if (line == 1 && before.starts_with(byte_order_mark)) {
        before.remove_prefix(byte_order_mark.size());
    }
    const auto column = 1 + std::count_if(before.begin(), before.end(), starts_character);
    constexpr std::size_t longest_pointer = 200;
    const std::string place = "line " + std::to_string(line) + ", column " + std::to_string(column);
    return Error(
        name_ + ": " +
        (pointer.empty() ? place : printable(pointer, longest_pointer) + " (" + place + ")") +
        ": " + std::string(message));
}

bool JsonValue::boolean() const { return first() == 't'; }

double JsonValue::number() const { return number_at(document_->text().substr(offset())); }

std::string JsonValue::text() const {
    std::string buffer;
    return std::string(decoded(document_->text(), offset(), buffer));
}

bool JsonValue::is_text(std::string_view text) const {
    std::string buffer;
    return decoded(document_->text(), offset(), buffer) == text;
}

JsonRange<JsonValue> JsonValue::items() const { return {*document_, entry_ + 2, end()}; }

JsonRange<JsonMember> JsonValue::members() const { return {*document_, entry_ + 2, end()}; }

std::string JsonValue::description() const {
    switch (kind()) {
        case JsonKind::null:
            return "null";
        case JsonKind::boolean:
            return boolean() ? "true" : "false";
        case JsonKind::number:
            return number_text(number());
        case JsonKind::text:
            return "the text " + in_quotes(text());
        case JsonKind::object:
            return "an object";
        case JsonKind::list:
            break;
    }
    const std::size_t count = items().size();
    return count == 0   ? "an empty list"
           : count == 1 ? "a list of 1 value"
                        : "a list of " + std::to_string(count) + " values";
}

std::optional<JsonValue> find_member(const JsonValue& object, std::string_view key) {
    for (const JsonMember member : object.members()) {
        if (member.key.is_text(key)) return member.value;
    }
    return std::nullopt;
}

JsonValue nearest_to(const JsonValue& root, std::string_view pointer) {
    JsonValue value = root;
    while (!pointer.empty()) {
        pointer.remove_prefix(1);  // the slash
        const std::string_view escaped = pointer.substr(0, pointer.find('/'));
        pointer.remove_prefix(escaped.size());
        std::optional<JsonValue> next;
        if (value.kind() == JsonKind::object) {
            for (const JsonMember member : value.members()) {
                if (pointer_into("", member.key.text()).substr(1) == escaped) next = member.value;
            }
        } else if (value.kind() == JsonKind::list) {
            std::size_t index = std::numeric_limits<std::size_t>::max();
            std::from_chars(escaped.data(), escaped.data() + escaped.size(), index);
            for (const JsonValue item : value.items()) {
                if (index-- == 0) {
                    next = item;
                    break;
                }
            }
        }
        if (!next) break;
        value = *next;
    }
    return value;
}

std::string pointer_into(std::string_view pointer, std::string_view key) {
    std::string path(pointer);
    path += '/';
    for (const char c : key) {
        if (c == '~') {
            path += "~0";
        } else if (c == '/') {
            path += "~1";
        } else {
            path += c;
        }
    }
    return path;
}

JsonDocument parse_json(const SourceText& source, const Stop& stop) {
    constexpr std::size_t most_bytes = std::numeric_limits<std::uint32_t>::max();
    if (source.text().size() >= most_bytes) {
        throw source.fault(0, "", "the text has 4 GiB or more; a scene must be smaller");
    }
    const std::size_t most_entries = survey_and_refuse(source, stop);
    return {source.text(), Parser(source, most_entries, stop).parse()};
}

}  // namespace ivory
