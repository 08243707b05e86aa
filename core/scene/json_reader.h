// Strict JSON (RFC 8259) as a tree that remembers where each value stands in its text, so that a
// message can say the line. Duplicate keys, which JSON libraries drop silently, are faults.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "core/scene/error.h"

namespace ivory {

// No file of Ivory needs half of these brackets within brackets.
inline constexpr std::size_t deepest_nesting = 32;

// A text and what messages call it. Views: the text must outlive it.
class SourceText {
  public:
    // `name` is escaped, so that it may hold anything.
    SourceText(std::string_view text, std::string_view name);

    [[nodiscard]] std::string_view text() const { return text_; }

    // "NAME: line 3, column 16: MESSAGE", or "NAME: POINTER (line 3, column 16): MESSAGE" where
    // there is a pointer. `offset` in bytes from 0 to the size; columns count characters from 1.
    [[nodiscard]] Error fault(std::size_t offset, std::string_view pointer,
                              std::string_view message) const;

  private:
    std::string_view text_;
    std::string name_;
};

struct JsonMember;

struct JsonValue {
    using Array = std::vector<JsonValue>;
    using Object = std::vector<JsonMember>;  // in file order, no key twice

    std::variant<std::nullptr_t, bool, double, std::string, Array, Object> content;
    std::size_t offset = 0;  // of the value's first byte in the text

    // "an object", "text", "-3": what a message says where another kind was expected.
    [[nodiscard]] std::string description() const;
};

struct JsonMember {
    std::string key;
    std::size_t offset = 0;  // of the key
    JsonValue value;
};

// The value of `key`, or null.
[[nodiscard]] const JsonValue* find_member(const JsonValue::Object& object, std::string_view key);

// The value that a JSON pointer (RFC 6901) leads to, or the last one on its way that is there.
[[nodiscard]] const JsonValue& nearest_to(const JsonValue& root, std::string_view pointer);

// `pointer` with one more key, escaped as RFC 6901 says.
[[nodiscard]] std::string pointer_into(std::string_view pointer, std::string_view key);

// Numbers become the nearest doubles, "-0" becomes -0.0; one beyond the largest double is a fault.
// A byte order mark is passed over. Throws Error, one line, at the first fault: not JSON, a key
// twice in one object, nesting beyond `deepest_nesting`, not UTF-8.
[[nodiscard]] JsonValue parse_json(const SourceText& source);

}  // namespace ivory
