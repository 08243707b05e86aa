#include "app/document/document_view.h"

#include <cstddef>
#include <utility>

namespace ivory {

namespace {

constexpr std::size_t most_kept = 1000;

}  // namespace

void DocumentView::go(const Place& to) {
    camera = to.camera;
    automatic = to.automatic;
    is_section = to.is_section;
}

void DocumentView::move_on(const Camera& to, bool section) {
    if (to == camera) return;
    if (!before_) {
        before_ = here();
        ++gestures_;
    }
    go({to, false, section});
}

void DocumentView::end_move() {
    if (!before_) return;
    const Place before = *std::exchange(before_, std::nullopt);
    if (before.camera == camera) {  // back to where it began
        go(before);
        return;
    }
    left_.push_back(before);
    if (left_.size() > most_kept) left_.erase(left_.begin());
    undone_.clear();
}

void DocumentView::cancel_move() {
    if (before_) go(*std::exchange(before_, std::nullopt));
}

void DocumentView::move_to(const Camera& to) {
    end_move();
    move_on(to);
    end_move();
}

bool DocumentView::undo() {
    end_move();
    if (left_.empty()) return false;
    undone_.push_back(here());
    go(left_.back());
    left_.pop_back();
    return true;
}

bool DocumentView::redo() {
    end_move();
    if (undone_.empty()) return false;
    left_.push_back(here());
    go(undone_.back());
    undone_.pop_back();
    return true;
}

}  // namespace ivory
