#include "core/scene/json_reader.h"

#include <algorithm>
#include <charconv>
#include <limits>

#include "core/scene/json_text.h"
#include "core/scene/text.h"

namespace ivory {

using json_text::byte_order_mark;
using json_text::decoded;
using json_text::number_at;
using json_text::starts_character;

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
    return std::string(text(buffer));
}

std::string_view JsonValue::text(std::string& buffer) const {
    return decoded(document_->text(), offset(), buffer);
}

bool JsonValue::is_word(std::string_view word) const {
    const std::string_view rest = document_->text().substr(offset() + 1);
    if (rest.size() > word.size() && rest[word.size()] == '"' && rest.starts_with(word))
        return true;
    std::string buffer;
    return text(buffer) == word;
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
        if (member.key.is_word(key)) return member.value;
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

}  // namespace ivory
