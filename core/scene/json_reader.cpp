#include "core/scene/json_reader.h"

#include <algorithm>
#include <charconv>
#include <cstdint>
#include <iterator>
#include <nlohmann/json.hpp>
#include <optional>
#include <unordered_set>
#include <utility>

#include "core/scene/text.h"

namespace ivory {
namespace {

constexpr std::string_view byte_order_mark = "\xEF\xBB\xBF";

// In well-formed UTF-8.
bool starts_character(char c) { return (static_cast<unsigned char>(c) & 0xC0) != 0x80; }

// What the parser takes its bytes from. It reads through a copy, and `reached` tells how far.
class CountingIterator {
  public:
    // NOLINTBEGIN(readability-identifier-naming): the standard's names
    using iterator_category = std::input_iterator_tag;
    using value_type = char;
    using difference_type = std::ptrdiff_t;
    using pointer = const char*;
    using reference = const char&;
    // NOLINTEND(readability-identifier-naming)

    CountingIterator(const char* at, const char** reached) : at_(at), reached_(reached) {}
    reference operator*() const { return *at_; }
    CountingIterator& operator++() {
        *reached_ = ++at_;
        return *this;
    }
    CountingIterator operator++(int) {
        const CountingIterator before = *this;
        ++*this;
        return before;
    }
    friend bool operator==(const CountingIterator& a, const CountingIterator& b) {
        return a.at_ == b.at_;
    }

  private:
    const char* at_;
    const char** reached_;
};

// Builds the tree from the events of nlohmann's parser. Each event comes as soon as the last byte
// of its token is read, one more byte for numbers (whose end shows only there).
class TreeBuilder {
  public:
    TreeBuilder(const SourceText& source, const char* const& reached)
        : source_(source),
          reached_(reached),
          end_of_last_(source.text().starts_with(byte_order_mark) ? byte_order_mark.size() : 0) {}

    JsonValue take() { return std::move(root_); }

    bool null() { return add(nullptr); }
    bool boolean(bool value) { return add(value); }
    bool number_integer(std::int64_t value) {
        // Negative numbers and "-0", whose sign an integer cannot keep, come here; others do not.
        return add(value == 0 ? -0.0 : static_cast<double>(value));
    }
    bool number_unsigned(std::uint64_t value) { return add(static_cast<double>(value)); }
    bool number_float(double value, const std::string& /*as_written*/) { return add(value); }
    bool string(std::string& value) { return add(std::move(value)); }
    bool binary(std::vector<std::uint8_t>& /*value*/) { return false; }  // never in JSON text

    bool start_object(std::size_t /*unknown_size*/) { return open(JsonValue::Object{}); }
    bool start_array(std::size_t /*unknown_size*/) { return open(JsonValue::Array{}); }
    bool end_object() { return close(); }
    bool end_array() { return close(); }

    bool key(std::string& text) {
        const std::size_t offset = start_of_token();
        token_is_read();
        Level& level = levels_.back();
        auto& members = std::get<JsonValue::Object>(level.value->content);
        if (!level.keys.insert(text).second) {
            throw source_.fault(offset, pointer_into(pointer(levels_.size() - 1), text),
                                "the key " + in_quotes(text) +
                                    " stands here for the second time in its object; keep one");
        }
        members.push_back({std::move(text), offset, {}});
        return true;
    }

    [[noreturn]] bool parse_error(std::size_t position, const std::string& last_token,
                                  const nlohmann::json::exception& error) {
        constexpr int out_of_range = 406;
        if (error.id == out_of_range) {
            throw source_.fault(start_of_token(), pointer(levels_.size()),
                                "the number " + in_quotes(last_token) +
                                    " is not finite as a double; it must lie within "
                                    "+-1.7976931348623157e308");
        }
        // The end counts as a byte read.
        if (position > source_.text().size()) {
            throw source_.fault(source_.text().size(), "",
                                levels_.empty()
                                    ? std::string("the text ends where a value should stand; it "
                                                  "must be one JSON object")
                                    : "the text ends inside " + innermost() +
                                          "; close it, or restore the part that was cut off");
        }
        const std::size_t offset = std::max<std::size_t>(position, 1) - 1;
        throw source_.fault(offset, "", syntax_fault(error.what(), last_token, offset));
    }

  private:
    struct Level {
        JsonValue* value;  // an array or object still open
        std::unordered_set<std::string> keys;
    };

    // Between the end of one token and the start of the next stand only these. The byte read after
    // a number is one of them too, or a bracket that closes, which starts no value.
    std::size_t start_of_token() const {
        const std::size_t start = source_.text().find_first_not_of(" \t\r\n,:", end_of_last_);
        return std::min(start, source_.text().size());
    }

    void token_is_read() {
        end_of_last_ = static_cast<std::size_t>(reached_ - source_.text().data());
    }

    template <class Content>
    JsonValue& place(Content&& content) {
        JsonValue value{std::forward<Content>(content), start_of_token()};
        token_is_read();
        if (levels_.empty()) return root_ = std::move(value);
        JsonValue& parent = *levels_.back().value;
        if (auto* const array = std::get_if<JsonValue::Array>(&parent.content)) {
            return array->emplace_back(std::move(value));
        }
        return std::get<JsonValue::Object>(parent.content).back().value = std::move(value);
    }

    template <class Content>
    bool add(Content&& content) {
        place(std::forward<Content>(content));
        return true;
    }

    template <class Content>
    bool open(Content&& content) {
        if (levels_.size() == deepest_nesting) {
            throw source_.fault(start_of_token(), "",
                                "brackets nest deeper than " + std::to_string(deepest_nesting) +
                                    " levels; the format needs a few");
        }
        // A container grows only while no child is open, so the pointers stay good.
        JsonValue& value = place(std::forward<Content>(content));
        levels_.push_back({&value, {}});
        return true;
    }

    bool close() {
        token_is_read();
        levels_.pop_back();
        return true;
    }

    // Of the value that the outermost `count` open levels lead to; where all of them are taken, of
    // the one that is about to be added.
    std::string pointer(std::size_t count) const {
        std::string path;
        for (std::size_t i = 0; i < count; ++i) {
            const bool is_being_added = i + 1 == levels_.size();
            if (const auto* const array =
                    std::get_if<JsonValue::Array>(&levels_[i].value->content)) {
                path += "/" + std::to_string(array->size() - (is_being_added ? 0 : 1));
            } else {
                path = pointer_into(
                    path, std::get<JsonValue::Object>(levels_[i].value->content).back().key);
            }
        }
        return path;
    }

    std::string innermost() const {
        const bool is_array =
            std::holds_alternative<JsonValue::Array>(levels_.back().value->content);
        const std::string path = pointer(levels_.size() - 1);
        return (is_array ? "the list " : "the object ") +
               (path.empty() ? std::string("of the top level") : printable(path, 200));
    }

    // The parser's own words are "[json.exception...] parse error at line 1, column 2: syntax error
    // while parsing value - FAULT; last read: 'TOKEN'; expected REMEDY", where a fault may be
    // "unexpected ...", without a token, and the remedy may be missing.
    std::string syntax_fault(std::string what, const std::string& token, std::size_t offset) const {
        for (const std::string_view before : {"syntax error ", " - "}) {
            const std::size_t at = what.find(before);
            if (at != std::string::npos) what.erase(0, at + before.size());
        }
        const std::string last_read = "; last read: '" + token + "'";
        const std::size_t at = what.find(last_read);
        if (at != std::string::npos) {
            what.replace(at, last_read.size(), " at " + in_quotes(character_at(offset)));
        }
        const std::string key_expected = "; expected string literal";
        if (what.ends_with(key_expected)) {
            what.replace(what.size() - key_expected.size(), key_expected.size(),
                         "; expected a key in double quotes");
        } else if (what.ends_with("; expected ']'") || what.ends_with("; expected '}'")) {
            what.insert(what.size() - 3, "',' or ");  // the parser names one of the two
        } else if (what.starts_with("invalid literal") &&
                   what.find("; expected") == std::string::npos) {
            what += "; expected '[', '{', or a literal";
        } else if (what.find("after backslash") != std::string::npos) {
            what += R"(; expected one of " \ / b f n r t u)";
        }
        return "not JSON: " + printable(what, 200);
    }

    std::string_view character_at(std::size_t offset) const {
        const std::string_view text = source_.text();
        std::size_t end = offset + 1;
        while (end < text.size() && !starts_character(text[end])) ++end;
        return text.substr(offset, end - offset);
    }

    const SourceText& source_;
    const char* const& reached_;
    std::size_t end_of_last_;
    JsonValue root_;
    std::vector<Level> levels_;
};

// The parser would take a zero byte for the end.
void refuse_bytes_of_no_text(const SourceText& source) {
    const std::string_view text = source.text();
    if (const std::optional<std::size_t> at = first_invalid_utf8(text)) {
        throw source.fault(*at, "",
                           "the byte " + printable(text.substr(*at, 1)) +
                               " is not valid UTF-8; save the file as UTF-8 text");
    }
    const auto is_control = [](char c) {
        return static_cast<unsigned char>(c) < 0x20 && c != '\t' && c != '\n' && c != '\r';
    };
    const auto control = std::find_if(text.begin(), text.end(), is_control);
    if (control != text.end()) {
        throw source.fault(static_cast<std::size_t>(control - text.begin()), "",
                           "the control character " + printable({&*control, 1}) +
                               " cannot stand in JSON; remove it, or write it as \\u00.. within "
                               "quotes");
    }
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

std::string JsonValue::description() const {
    struct Describe {
        std::string operator()(std::nullptr_t) const { return "null"; }
        std::string operator()(bool value) const { return value ? "true" : "false"; }
        std::string operator()(double value) const { return number_text(value); }
        std::string operator()(const std::string& value) const {
            return "the text " + in_quotes(value);
        }
        std::string operator()(const Array& items) const {
            return items.empty()       ? "an empty list"
                   : items.size() == 1 ? "a list of 1 value"
                                       : "a list of " + std::to_string(items.size()) + " values";
        }
        std::string operator()(const Object&) const { return "an object"; }
    };
    return std::visit(Describe{}, content);
}

const JsonValue* find_member(const JsonValue::Object& object, std::string_view key) {
    const auto member = std::find_if(object.begin(), object.end(),
                                     [&](const JsonMember& m) { return m.key == key; });
    return member == object.end() ? nullptr : &member->value;
}

const JsonValue& nearest_to(const JsonValue& root, std::string_view pointer) {
    const JsonValue* value = &root;
    while (!pointer.empty()) {
        pointer.remove_prefix(1);  // the slash
        const std::string_view escaped = pointer.substr(0, pointer.find('/'));
        pointer.remove_prefix(escaped.size());
        const JsonValue* next = nullptr;
        if (const auto* const object = std::get_if<JsonValue::Object>(&value->content)) {
            for (const JsonMember& member : *object) {
                if (pointer_into("", member.key).substr(1) == escaped) next = &member.value;
            }
        } else if (const auto* const array = std::get_if<JsonValue::Array>(&value->content)) {
            std::size_t index = array->size();
            std::from_chars(escaped.data(), escaped.data() + escaped.size(), index);
            if (index < array->size()) next = &(*array)[index];
        }
        if (next == nullptr) break;
        value = next;
    }
    return *value;
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

JsonValue parse_json(const SourceText& source) {
    refuse_bytes_of_no_text(source);
    const std::string_view text = source.text();
    const char* reached = text.data();
    TreeBuilder builder(source, reached);
    nlohmann::json::sax_parse(CountingIterator(text.data(), &reached),
                              CountingIterator(text.data() + text.size(), &reached), &builder);
    return builder.take();
}

}  // namespace ivory
