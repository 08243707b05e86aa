#include "core/trace/isolate.h"

#include <cmath>

#include "core/trace/safe_step.h"

namespace ivory {
namespace {

constexpr double u = unit_roundoff;

Interval<double> oriented(const Interval<double>& f, bool inside) { return inside ? -f : f; }

class Walk {
  public:
    Walk(const FieldAlongRay& field, const Interval<double>& span, const Precision& precision,
         int budget, Counts& counts)
        : field_(field),
          span_(span),
          precision_(precision),
          cancels_(!(field.magnitude() < most_magnitude * field.threshold())),
          hides_(!(static_cast<double>(field.size()) * field.magnitude() * u <
                   least_hidden * field.threshold())),
          left_(cancels_ ? std::min(budget, budget_of_cancelling) : budget),
          counts_(counts) {}

    Isolation run(Start start) {
        t_ = span_.lo;
        if (start == Start::unknown && !find_side()) return unresolved(span_.hi);
        double window = span_.hi - t_;
        while (!(t_ >= span_.hi)) {
            if (left_ <= 0) return unresolved(span_.hi);
            if (hides_ && --steps_until_looking_ahead_ == 0) {
                if (!pass_hidden()) return unresolved(span_.hi);
                window = span_.hi - t_;
                continue;
            }
            const double end = std::min(std::max(t_ + window, next_up(t_)), span_.hi);
            const Enclosure e = over(end);
            if (e.value.hi < 0) {
                t_ = end;
                window *= 2;
                continue;
            }
            if (e.left.hi < 0) {
                const double width = sub_up(end, t_);
                const double step =
                    std::max(parabola_step(e.left.hi, e.left_slope.hi, e.curvature.hi, width),
                             line_step(e.left.hi, e.slope.hi, width));
                if (step >= width) {
                    t_ = end;
                    window = 2 * width;
                    continue;
                }
                // The lower parabola crosses 0 no earlier than f does: where it does so at once, a
                // root is close, and the next window only has to hold it.
                const double latest =
                    parabola_step(e.left.lo, e.left_slope.lo, e.curvature.lo, width);
                const double cell = precision_.cell_at(t_);
                t_ = std::max(t_, add_down(t_, step));
                window = latest < width ? 1.25 * (latest - step) + cell : 2 * step + cell;
                const bool near = latest < width && latest - step < cell;
                if (!near && step > 0.25 * cell) continue;
            }
            // A root is near, or rounding hides the sign.
            switch (const Isolation end_of_walk = close(); close_) {
                case Close::found:
                    return end_of_walk;
                case Close::none_near:
                    window = 4 * precision_.cell_at(t_);
                    break;
                case Close::doubtful:
                    window = 4 * precision_.cell_at(t_);
                    break;
            }
        }
        if (inside_)
            return unresolved(span_.hi);  // f < 0 beyond the span: not reached but by rounding
        if (doubt_.lo <= doubt_.hi) return {Status::unresolved, doubt_};
        return {Status::miss, Interval<double>::empty_set()};
    }

  private:
    enum class Close : unsigned char { found, none_near, doubtful };

    // One evaluation. Who is to stop has none left.
    void count() {
        --left_;
        if (counts_.add(1, field_.size())) left_ = 0;
    }

    Enclosure over(double end) {
        count();
        Enclosure e = field_.over(t_, end);
        if (inside_) {
            e = {-e.left, -e.right, -e.value, -e.left_slope, -e.slope, -e.curvature};
        }
        return e;
    }

    // f(t) with the sign that makes it negative before the first root. f < 0 beyond the span.
    Interval<double> at(double t) {
        if (t >= span_.hi) {
            return oriented({-infinity<double>, -smallest<double>}, inside_);
        }
        count();
        return oriented(field_.at(std::max(t, span_.lo)), inside_);
    }

    // Where elements cancel that are 2^50 times as strong as T, rounding hides f far and wide, and
    // steps shrink long before, since windows enclose each element by itself. So after a few steps
    // the signs further on are looked at: where a hidden stretch lies ahead with no other side of 0
    // between, and the old sign after it, all from here to there is in doubt, as it would be when
    // the walk had come to the stretch. False: rounding hides the sign up to the end of the span.
    bool pass_hidden() {
        constexpr int halvings = 12, closer = 8;
        double sure = t_, hidden = infinity<double>;
        for (double ahead = std::ldexp(span_.hi - t_, -halvings); left_ > 0; ahead *= 2) {
            const double t = t_ + ahead;
            if (!(t < span_.hi)) return true;
            const Interval<double> f = at(t);
            if (f.lo > 0) return true;
            if (!(f.hi < 0)) {
                hidden = t;
                break;
            }
            sure = t;
        }
        for (int i = 0; i < closer && left_ > 0; ++i) {
            const double middle = 0.5 * (sure + hidden);
            const Interval<double> f = at(middle);
            if (f.lo > 0) return true;
            (f.hi < 0 ? sure : hidden) = middle;
        }
        for (double ahead = hidden - t_; left_ > 0 && hidden + ahead < span_.hi; ahead *= 1.5) {
            const Interval<double> f = at(hidden + ahead);
            if (f.lo > 0) return true;
            if (!(f.hi < 0)) continue;
            put_in_doubt(hidden + ahead);
            return true;
        }
        return inside_;
    }

    // [t_, end]. What comes after it only tells how far the first root may be: where rounding hides
    // so much, little is spent on that.
    void put_in_doubt(double end) {
        constexpr int budget_after_doubt = 8;
        doubt_ = hull(doubt_, Interval<double>(t_, end));
        t_ = end;
        if (hides_) left_ = std::min(left_, budget_after_doubt);
    }

    // The side on which the ray starts. Where rounding hides it, the start up to the first place
    // with a certain sign is in doubt: the first root may lie there.
    bool find_side() {
        const double cell = precision_.cell_at(t_);
        for (double ahead = 0; t_ + ahead < span_.hi && left_ > 0;
             ahead = ahead == 0 ? cell : 2 * ahead) {
            const Interval<double> f = at(t_ + ahead);
            if (!(f.lo > 0) && !(f.hi < 0)) continue;
            inside_ = f.lo > 0;
            if (ahead > 0) doubt_ = {t_, t_ + ahead};
            t_ += ahead;
            return true;
        }
        return false;
    }

    Isolation unresolved(double end) const {
        return {Status::unresolved, {std::min(t_, doubt_.lo), end}};
    }

    // A root in [t_, hi] is certain. Earlier doubts make it the last place where the first root can
    // be.
    Isolation found(double lo, double hi) {
        close_ = Close::found;
        if (is_empty(doubt_)) return {Status::hit, {std::max(lo, 0.0), hi}};
        return {Status::unresolved, {doubt_.lo, hi}};
    }

    // Ends the walk on the grid if it can: [t_, hi] holds a root where f changes its sign between
    // them, and [0, t_) holds none. Where f keeps its sign at the next grid line the walk goes on;
    // where rounding hides signs on and on, up to the first place with a certain one.
    Isolation close() {
        const double cell = precision_.cell_at(t_);
        const double line = std::floor(t_ / cell) * cell;
        double lo = line;
        if (lo > span_.lo && !(at(lo).hi < 0)) lo -= cell;
        bool hidden = false;
        double ahead = cell;
        while (left_ > 0) {
            const double hi = line + ahead;
            const Interval<double> g = at(hi);
            if (g.lo > 0) return found(lo, hi);
            if (g.hi < 0) return nothing_certain(lo, hi, hidden);
            hidden = true;
            if (hi >= span_.hi) break;
            ahead = ahead < 4 * cell ? ahead + cell : 2 * ahead;
        }
        close_ = Close::found;
        return unresolved(span_.hi);
    }

    // f has its old sign at hi again. Between t_ and hi it may have touched 0, or passed it twice.
    // Where f keeps its sign at t_ too, the walk tries smaller windows first, once in a cell.
    Isolation nothing_certain(double lo, double hi, bool hidden) {
        if (!hidden && t_ > last_none_ + 0.5 * (hi - lo) && at(t_).hi < 0) {
            last_none_ = t_;
            close_ = Close::none_near;
            return {};
        }
        // The top of the parabola through what is known at t_, then ever closer to t_.
        const Enclosure e = over(hi);
        const double top = -midpoint(e.left_slope) / midpoint(e.curvature);
        double ahead = top > 0 && t_ + top < hi ? top : 0.5 * (hi - t_);
        for (int i = 0; i < 24 && left_ > 0 && t_ + ahead > t_; ++i, ahead *= 0.5) {
            if (at(t_ + ahead).lo > 0) return found(lo, hi);
        }
        put_in_doubt(hi);
        close_ = Close::doubtful;
        return {};
    }

    const FieldAlongRay& field_;
    const Interval<double> span_;
    const Precision precision_;
    // The elements' peaks add up to so many times T that windows say little where they cancel; to
    // so many that rounding may hide f. Ordinary fields are far from both.
    static constexpr double most_magnitude = 0x1p20, least_hidden = 0x1p-4;
    static constexpr int budget_of_cancelling = 1500;
    const bool cancels_, hides_;
    int steps_until_looking_ahead_ = 8;
    int left_;
    Counts& counts_;
    double t_ = 0;  // f has no root on [0, t_) outside of doubt_, and the sign of its side there
    bool inside_ = false;  // f > 0 there
    double last_none_ = -infinity<double>;
    Interval<double> doubt_ = Interval<double>::empty_set();  // may hold the first root
    Close close_ = Close::found;
};

}  // namespace

double Precision::cell_at(double t) const {
    // 8 ulp(t) = 2^(exponent - 50) for t in [2^(exponent - 1), 2^exponent).
    if (t == 0) return cell;
    int exponent = 0;
    std::frexp(t, &exponent);
    return std::max(cell, std::ldexp(1.0, exponent - 50));
}

Isolation isolate_first_root(const FieldAlongRay& field, const Interval<double>& span, Start start,
                             const Precision& precision, int budget, Counts& counts) {
    return Walk(field, span, precision, budget, counts).run(start);
}

}  // namespace ivory
