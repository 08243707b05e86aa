#include "core/trace/descent.h"

namespace ivory {

bool Descent::build(const Field& field, const ElementList& list, const Bundle& bundle,
                    double tolerance, bool skips_windows, const CommonBundle* common,
                    Cancellation* stop) {
    span_ = Interval<double>::empty_set();
    is_shared_ = false;
    open_.clear();
    if (!field_.build(field, list, bundle, tolerance, skips_windows, stop)) return false;
    if (list.certainly_empty || field.box.empty()) return true;
    span_ = field_.span_of(bundle);
    if (!is_empty(span_) && common != nullptr) share(*common);
    return true;
}

void Descent::begin(std::span<const BundlePart> parts, const RayColumns& rays, int budget,
                    bool condenses) {
    left_ = budget;
    parts_ = parts;
    rays_ = rays;
    open_.clear();
    if (is_empty(span_)) return;
    field_.begin(is_shared_ ? common_ : parts[0], condenses);
    open_.push_back(
        is_shared_
            ? shared_piece(0, 0)
            : Piece{.begin = span_.lo, .end = span_.hi, .part = parts[0], .root = &field_.list()});
}

Window* Descent::take(const Piece& piece) {
    return piece.is_shared() ? take_shared(piece) : take_own(piece);
}

Window* Descent::take_own(const Piece& piece) {
    if (left_-- <= 0) return give_up();
    const double t0 = piece.begin, t1 = piece.end, pad = BundleField::pad_of(t0, t1);
    const BundlePart& part = piece.part;
    if (bounded_by_depth_.size() <= piece.depth) bounded_by_depth_.resize(piece.depth + 1);
    const Bounded& parent = piece.depth == 0 ? *piece.root : bounded_by_depth_[piece.depth - 1];
    Bounded& here = bounded_by_depth_[piece.depth];
    const bool divisible = is_divisible(piece);
    const bool halves = divisible && field_.is_long(t0, t1);
    const bool may_meet = field_.bound(parent, here, part, t0 - pad, t1 + pad, halves);
    if (field_.is_stopped()) left_ = 0;
    if (!may_meet) return nullptr;
    if (!halves && field_.is_crowded(here)) {
        const bool may_part = !has_single_rays(part) && piece.depth < greatest_depth;
        const Condensing done = field_.condense(part, t0, t1, may_part, here);
        if (done == Condensing::condensed && field_.is_below(here)) return nullptr;
        if (done == Condensing::too_large && divisible) {
            if (may_part && 2 * width_at(part, t1) > t1 - t0) {
                part_up(piece);
            } else {
                halve(piece);
            }
            return nullptr;
        }
    }
    if (!halves && !here.is_condensed) field_.bound_curvature(part, t0 - pad, t1 + pad, here);

    const bool divides = halves || (divisible && field_.is_too_curved(here, t1 - t0));
    const bool parts_there = has_parts(piece);
    // Where the rays are farther apart than the stretch is long, to halve it says less of each of
    // them than to part them.
    if (divides && !(parts_there && width_at(part, t1) > t1 - t0)) {
        halve(piece);
        return nullptr;
    }
    const bool parts_differ = !has_single_rays(part) && !here.is_condensed &&
                              here.size() >= parts_elements &&
                              width_at(part, t1) > parts_apart * (t1 - t0);
    if (parts_there && (divides || parts_differ)) {
        part_up(piece);
        return nullptr;
    }
    part_ = part;
    return &field_.open(here, part, t0, t1);
}

void Descent::halve(const Piece& piece) {
    const double middle = 0.5 * (piece.begin + piece.end);
    open_.push_back(
        {.begin = middle, .end = piece.end, .part = piece.part, .depth = piece.depth + 1});
    open_.push_back(
        {.begin = piece.begin, .end = middle, .part = piece.part, .depth = piece.depth + 1});
}

void Descent::part_up(const Piece& piece) {
    const BundlePart& part = piece.part;
    Piece of_part = piece;
    of_part.depth = piece.depth + 1;
    if (has_single_rays(part)) {
        for (std::uint32_t k = part.end; k-- > part.first;) {
            of_part.part = {
                .axis = rays_[k], .origin = rays_.origin(k, part.origin), .first = k, .end = k + 1};
            open_.push_back(of_part);
        }
    } else {
        for (std::uint32_t k = part.end_of_parts; k-- > part.first_part;) {
            of_part.part = parts_[k];
            open_.push_back(of_part);
        }
    }
}

bool Descent::has_parts(const Piece& piece) const {
    const BundlePart& part = piece.part;
    return piece.depth < greatest_depth &&
           (!has_single_rays(part) ||
            (parts_.size() > 1 && width_at(part, 1) > 0 && rays_.x != nullptr));
}

Window* Descent::give_up() {
    open_.clear();
    part_ = parts_[0];
    return &field_.open_unknown();
}

void Descent::share(const CommonBundle& common) {
    // Few elements are bounded sooner than looked up.
    if (!(common.bundle.spread <= 0.5) || field_.size() < parts_elements) return;
    common_ = whole_of(common.bundle);
    if (shared_number_ != common.number) {
        shared_number_ = common.number;
        shared_count_ = 0;
        const Interval<double> span = field_.span_of(common.bundle);
        if (is_empty(span) || is_too_wide_at(span.lo) ||
            span.hi - span.lo > longest_common * BundleField::long_stretch * field_.unit()) {
            return;
        }
        field_.take_list(*common.list, shared_list_);
        add_shared(span.lo, span.hi, 0);
    }
    is_shared_ = shared_count_ > 0;
}

bool Descent::is_too_wide_at(double t) const {
    return width_at(common_, t) > widest_common * field_.unit();
}

void Descent::add_shared(double begin, double end, std::size_t parent) {
    if (shared_.size() == shared_count_) shared_.emplace_back();
    SharedStretch& stretch = shared_[shared_count_++];
    stretch.begin = begin;
    stretch.end = end;
    stretch.parent = parent;
    stretch.first_half = 0;
    stretch.is_bounded = stretch.is_ended = false;
}

bool Descent::bound_shared(std::size_t index, bool halves) {
    SharedStretch& here = shared_[index];
    if (!here.is_bounded) {
        const Bounded& parent = index == 0 ? shared_list_ : shared_[here.parent].bounded;
        const double pad = BundleField::pad_of(here.begin, here.end);
        here.is_ended =
            !field_.bound(parent, here.bounded, common_, here.begin - pad, here.end + pad, halves);
        here.is_bounded = true;
        if (field_.is_stopped()) left_ = 0;
    }
    return !here.is_ended;
}

void Descent::halve_shared(std::size_t index) {
    if (shared_[index].first_half != 0) return;
    const double begin = shared_[index].begin, end = shared_[index].end;
    const double middle = 0.5 * (begin + end);
    shared_[index].first_half = shared_count_;
    add_shared(begin, middle, index);
    add_shared(middle, end, index);
}

Descent::Piece Descent::shared_piece(std::size_t index, std::size_t depth) const {
    return {.begin = shared_[index].begin,
            .end = shared_[index].end,
            .part = parts_[0],
            .depth = depth,
            .shared = index};
}

// Long stretches of the common bundle, as far as this one needs them; and then its own.
Window* Descent::take_shared(const Piece& piece) {
    const auto go_on_alone = [&](const Bounded& root) {
        open_.push_back({.begin = piece.begin, .end = piece.end, .part = parts_[0], .root = &root});
        return nullptr;
    };
    if (is_too_wide_at(piece.begin)) {  // the whole is not, or nothing is shared
        return go_on_alone(shared_[shared_[piece.shared].parent].bounded);
    }
    if (left_-- <= 0) return give_up();
    const bool halves = is_divisible(piece) && field_.is_long(piece.begin, piece.end);
    if (!bound_shared(piece.shared, halves)) return nullptr;
    if (!halves) return go_on_alone(shared_[piece.shared].bounded);
    halve_shared(piece.shared);
    const std::size_t first = shared_[piece.shared].first_half;
    open_.push_back(shared_piece(first + 1, piece.depth + 1));
    open_.push_back(shared_piece(first, piece.depth + 1));
    return nullptr;
}

}  // namespace ivory
