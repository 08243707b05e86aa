// Strict JSON (RFC 8259), read where it stands: of the text only the places of its values are
// kept, four bytes each, so that a large file costs little and a message can say the line.
// Duplicate keys, which JSON libraries drop silently, are faults.
#pragma once

#include <cstddef>
#include <cstdint>
#include <iterator>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/scene/error.h"
#include "core/scene/stop.h"

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

class JsonDocument;
struct JsonMember;

// What a list or an object holds, in file order. Counting them takes a walk over all.
template <class Item>
class JsonRange {
  public:
    class Iterator {
      public:
        // NOLINTBEGIN(readability-identifier-naming): the standard's names
        using iterator_category = std::input_iterator_tag;
        using value_type = Item;
        using difference_type = std::ptrdiff_t;
        using pointer = void;
        using reference = Item;
        // NOLINTEND(readability-identifier-naming)

        Iterator(const JsonDocument& document, std::size_t at) : document_(&document), at_(at) {}
        Item operator*() const { return Item(*document_, at_); }
        Iterator& operator++() {
            at_ = (**this).end();
            return *this;
        }
        friend bool operator==(const Iterator& a, const Iterator& b) { return a.at_ == b.at_; }

      private:
        const JsonDocument* document_;
        std::size_t at_;
    };

    JsonRange(const JsonDocument& document, std::size_t begin, std::size_t end)
        : begin_(document, begin), end_(document, end) {}

    [[nodiscard]] Iterator begin() const { return begin_; }
    [[nodiscard]] Iterator end() const { return end_; }
    [[nodiscard]] std::size_t size() const {
        return static_cast<std::size_t>(std::distance(begin_, end_));
    }

  private:
    Iterator begin_, end_;
};

enum class JsonKind : unsigned char { null, boolean, number, text, list, object };

// A value of a document. A view: the document and its text must outlive it.
class JsonValue {
  public:
    // The value whose entry in the document's index is the one at `entry`.
    JsonValue(const JsonDocument& document, std::size_t entry)
        : document_(&document), entry_(entry) {}

    [[nodiscard]] JsonKind kind() const;
    [[nodiscard]] std::size_t offset() const;  // of the value's first byte in the text

    // Each of a value of that kind only. A number is the nearest double to what is written, "-0"
    // is -0.0; a text is what its escapes stand for.
    [[nodiscard]] bool boolean() const;
    [[nodiscard]] double number() const;
    [[nodiscard]] std::string text() const;
    // A part of the document's text, or of `buffer` where there are escapes.
    [[nodiscard]] std::string_view text(std::string& buffer) const;
    // Whether it is the text `word`, which has neither quotes nor backslashes.
    [[nodiscard]] bool is_word(std::string_view word) const;
    [[nodiscard]] JsonRange<JsonValue> items() const;     // of a list
    [[nodiscard]] JsonRange<JsonMember> members() const;  // of an object, no key twice

    // "an object", "text", "-3": what a message says where another kind was expected.
    [[nodiscard]] std::string description() const;

    // The entry after those of this value.
    [[nodiscard]] std::size_t end() const;

  private:
    char first() const;

    const JsonDocument* document_;
    std::size_t entry_;
};

struct JsonMember {
    JsonMember(const JsonDocument& document, std::size_t entry)
        : key(document, entry), value(document, entry + 1) {}
    [[nodiscard]] std::size_t end() const { return value.end(); }

    JsonValue key;  // a text
    JsonValue value;
};

// A text that is JSON, and an index of its values. Values point to it, so that it cannot be moved.
class JsonDocument {
  public:
    // The offset of each value and key, in file order; that of a list or object is followed by the
    // number of the entry that comes after its last item.
    JsonDocument(std::string_view text, std::vector<std::uint32_t> index)
        : text_(text), index_(std::move(index)) {}
    JsonDocument(const JsonDocument&) = delete;
    JsonDocument& operator=(const JsonDocument&) = delete;

    [[nodiscard]] JsonValue root() const { return {*this, 0}; }
    [[nodiscard]] std::string_view text() const { return text_; }
    [[nodiscard]] const std::vector<std::uint32_t>& index() const { return index_; }

  private:
    std::string_view text_;
    std::vector<std::uint32_t> index_;
};

inline std::size_t JsonValue::offset() const { return document_->index()[entry_]; }

inline char JsonValue::first() const { return document_->text()[offset()]; }

inline JsonKind JsonValue::kind() const {
    switch (first()) {
        case '{':
            return JsonKind::object;
        case '[':
            return JsonKind::list;
        case '"':
            return JsonKind::text;
        case 't':
        case 'f':
            return JsonKind::boolean;
        case 'n':
            return JsonKind::null;
        default:
            return JsonKind::number;
    }
}

inline std::size_t JsonValue::end() const {
    const bool is_container = first() == '[' || first() == '{';
    return is_container ? document_->index()[entry_ + 1] : entry_ + 1;
}

// The value of `key`, which has neither quotes nor backslashes, or nothing.
[[nodiscard]] std::optional<JsonValue> find_member(const JsonValue& object, std::string_view key);

// The value that a JSON pointer (RFC 6901) leads to, or the last one on its way that is there.
[[nodiscard]] JsonValue nearest_to(const JsonValue& root, std::string_view pointer);

// `pointer` with one more key, escaped as RFC 6901 says.
[[nodiscard]] std::string pointer_into(std::string_view pointer, std::string_view key);

// The text must outlive the document. A byte order mark is passed over. Throws Error, one line, at
// the first fault: not JSON, a key twice in one object, nesting beyond `deepest_nesting`, a number
// beyond the largest double, not UTF-8, 4 GiB or more. Looks at `stop` at least once in
// `bytes_between_looks`.
[[nodiscard]] JsonDocument parse_json(const SourceText& source, const Stop& stop = {});

}  // namespace ivory
