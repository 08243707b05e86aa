// The search of a bundle along t, from front to back: a stretch on which no ray can meet the surface
// is passed over, one on which f'' is small enough becomes a window, any other is halved, or looked
// at for fewer of the rays (after fidget's render_tile_recurse, which does so in three dimensions).
//
// Long stretches are bounded for a wider bundle that several others are parts of (CommonBundle),
// each once, and then for each of these.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <span>
#include <vector>

#include "core/field/bundle_field.h"

namespace ivory {

// Reused from bundle to bundle: it keeps its memory.
class Descent {
  public:
    // Where fewer elements matter, shorter lists for parts of the rays do not pay.
    static constexpr std::size_t parts_elements = 12;

    // `list`, `tolerance`, `skips_windows`: as in BundleField::build. Long stretches are bounded for
    // the `common` bundle, unless that is null, much wider than elements are or very long, or
    // elements are few. Once `stop`, unless null, is seen, no more stretches are bounded, as if the
    // budget were spent. False: numbers beyond what the bounds are proved for; nothing else may be
    // called.
    bool build(const Field& field, const ElementList& list, const Bundle& bundle, double tolerance,
               bool skips_windows = true, const CommonBundle* common = nullptr,
               Cancellation* stop = nullptr);

    // The t outside of which every ray is outside of the field's box, and so f < 0; empty: a miss.
    [[nodiscard]] Interval<double> span() const { return span_; }

    // Begins at the front. parts[0] is the bundle; if there are more, each ray of one that has none
    // may be a part of its own, whose axis is that of the ray in `rays`. When `budget` stretches
    // have been bounded, one window for all rays that is not `coarse_usable` and begins at 0 is the
    // last. Both arrays have to stay. With `condenses` windows where elements are crowded may be condensed.
    void begin(std::span<const BundlePart> parts, const RayColumns& rays, int budget,
               bool condenses = false);

    // The next window, until it is asked again, and part() is whom it is for; null: there is none.
    // f < 0 certainly holds on the parts of span() between windows. Which there are depends on
    // field, lists, parts, common bundle and tolerance alone. Stretches that wanted(part, begin,
    // end) denies are passed over.
    template <class Wanted>
    [[nodiscard]] Window* next(const Wanted& wanted) {
        while (!open_.empty()) {
            const Piece piece = open_.back();
            open_.pop_back();
            if (piece.is_shared() && is_outside(piece)) continue;
            if (!wanted(piece.part, piece.begin, piece.end)) continue;
            if (Window* const window = take(piece)) return window;
        }
        return nullptr;
    }
    [[nodiscard]] const BundlePart& part() const { return part_; }

    // What the window is a window of: its finer stages.
    [[nodiscard]] BundleField& field() { return field_; }
    [[nodiscard]] const BundleField& field() const { return field_; }

  private:
    static constexpr std::size_t greatest_depth = 30;
    // Common bundles are of no use where they are wider than so many units, since then many
    // elements are in reach that its parts cannot see; nor where they are longer than so many long
    // stretches, which a part would end by its own list.
    static constexpr double widest_common = 8, longest_common = 128;
    // A window is made for each part of the rays where they are farther apart than this share of
    // its length.
    static constexpr double parts_apart = 1;

    static constexpr std::size_t own = ~std::size_t{0};

    // To be looked at: one that is shared, or one of this bundle, bounded as a part of another.
    struct Piece {
        double begin = 0, end = 0;
        BundlePart part;
        std::size_t depth = 0;          // halvings and partings, of the bundle or of what is shared
        std::size_t shared = own;       // index
        const Bounded* root = nullptr;  // at depth 0: what it is a part of

        [[nodiscard]] bool is_shared() const { return shared != own; }
    };

    // A stretch of the common bundle; in the order in which they came to be wanted.
    struct SharedStretch {
        double begin = 0, end = 0;
        std::size_t parent = 0;
        std::size_t first_half = 0;  // the second follows; 0: not halved (yet)
        bool is_bounded = false, is_ended = false;
        Bounded bounded;
    };

    void share(const CommonBundle& common);
    void add_shared(double begin, double end, std::size_t parent);
    bool bound_shared(std::size_t index, bool halves);
    void halve_shared(std::size_t index);
    [[nodiscard]] Piece shared_piece(std::size_t index, std::size_t depth) const;
    [[nodiscard]] bool is_too_wide_at(double t) const;
    [[nodiscard]] static double width_at(const BundlePart& part, double t) {
        return part.radius + t * part.spread;
    }

    // It lies outside of the bundle's own span.
    [[nodiscard]] bool is_outside(const Piece& piece) const {
        return piece.end < span_.lo || piece.begin > span_.hi;
    }
    // Ends it, divides it or makes it a window.
    Window* take(const Piece& piece);
    Window* take_shared(const Piece& piece);
    Window* take_own(const Piece& piece);
    Window* give_up();
    // Those of fewer rays; or of half the length.
    void part_up(const Piece& piece);
    void halve(const Piece& piece);

    [[nodiscard]] static bool is_divisible(const Piece& piece) {
        const double middle = 0.5 * (piece.begin + piece.end);
        return middle > piece.begin && middle < piece.end && piece.depth < greatest_depth;
    }
    // It has no parts but its rays.
    [[nodiscard]] static bool has_single_rays(const BundlePart& part) {
        return part.first_part == part.end_of_parts;
    }
    [[nodiscard]] bool has_parts(const Piece& piece) const;

    BundleField field_;
    Interval<double> span_ = Interval<double>::empty_set();
    std::span<const BundlePart> parts_;
    RayColumns rays_;
    std::vector<Piece> open_;                // the last comes next
    std::vector<Bounded> bounded_by_depth_;  // what the pieces above the next one are bounded by
    BundlePart part_;                        // of the window
    int left_ = 0;                           // of the budget

    bool is_shared_ = false;
    BundlePart common_;
    std::uint64_t shared_number_ = 0;
    Bounded shared_list_;
    std::deque<SharedStretch> shared_;  // those beyond shared_count_ keep their memory
    std::size_t shared_count_ = 0;
};

}  // namespace ivory
