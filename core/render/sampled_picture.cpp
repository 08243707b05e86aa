#include "core/render/sampled_picture.h"

#include <algorithm>
#include <memory>

#include "core/render/camera_lanes.h"
#include "core/render/shade_lanes.h"
#include "core/render/srgb.h"

namespace ivory {
namespace {

int rank(Status status) {
    switch (status) {
        case Status::unresolved:
            return 4;
        case Status::hit:
            return 3;
        case Status::claimed_hit:
            return 2;
        case Status::miss:
            return 1;
        case Status::claimed_miss:
            return 0;
    }
    return 0;
}

// The light of the larger picture's pixels, row after row.
class LightOfRows {
  public:
    LightOfRows(const Picture& picture, const Frame& frame)
        : picture_(picture), frame_(frame), lights_(std::make_unique<Lights>()) {}

    // Calls visit(i, light) for each pixel of row j.
    template <class Visit>
    void for_row(int j, const Visit& visit) {
        Lights& at = *lights_;
        constexpr int together = static_cast<int>(RayBundle::capacity);
        const double v = plane_v(picture_.view, frame_.height, j);
        for (int first = 0; first < frame_.width; first += together) {
            const int end = std::min(first + together, frame_.width);
            const auto size = static_cast<std::size_t>(end - first);
            at.surfaces.exact = false;
            at.surfaces.clear(size);
            for (std::size_t k = 0; k < size; ++k) {
                const int i = first + static_cast<int>(k);
                at.u[k] = plane_u(picture_.view, frame_.width, frame_.height, i);
                at.v[k] = v;
                const std::size_t pixel = frame_.at(i, j);
                if (possibly_hit(frame_.status[pixel]))
                    at.surfaces.set_seen(k, frame_.surface[pixel]);
            }
            primary_directions(picture_.view, size, at.u.data(), at.v.data(), at.rays.dx.data(),
                               at.rays.dy.data(), at.rays.dz.data());
            light_lanes(picture_.lighting, at.rays, at.surfaces, size, at.light);
            for (std::size_t k = 0; k < size; ++k) {
                visit(first + static_cast<int>(k),
                      Color{at.light.r[k], at.light.g[k], at.light.b[k]});
            }
        }
    }

  private:
    struct Lights {
        RayBundle rays;
        BundleSurfaces surfaces;
        LightColumns light;
        alignas(64) std::array<double, RayBundle::room> u, v;
    };

    const Picture& picture_;
    const Frame& frame_;
    std::unique_ptr<Lights> lights_;
};

}  // namespace

Status named_after(Status one, Status other) { return rank(other) > rank(one) ? other : one; }

SampledPicture::SampledPicture(const Canvas& canvas, int n, bool keep_depth)
    : samples_a_side(n),
      color(canvas.frame.size()),
      depth(keep_depth ? canvas.frame.size() : 0),
      pixels(canvas.grid.tiles.size()) {}

SampledPicture mean_of(const Picture& picture, const Canvas& larger, int samples_a_side) {
    const int n = samples_a_side;
    const Frame& frame = larger.frame;
    const Canvas size(frame.width / n, frame.height / n, false);
    SampledPicture mean(size, n, true);
    const SrgbTable& table = srgb_table();
    const double each = 1.0 / (n * n);
    LightOfRows lights(picture, frame);
    std::vector<Color> sums;
    std::vector<Status> status;
    for (int j = 0; j < size.frame.height; ++j) {
        sums.assign(static_cast<std::size_t>(size.frame.width), Color{});
        status.assign(sums.size(), Status::claimed_miss);
        std::fill_n(&mean.depth[size.frame.at(0, j)], sums.size(), infinity<double>);
        for (int row = j * n; row < (j + 1) * n; ++row) {
            lights.for_row(row, [&](int i, const Color& light) {
                const auto column = static_cast<std::size_t>(i / n);
                sums[column] = sums[column] + light;
                const std::size_t pixel = frame.at(i, row);
                status[column] = named_after(status[column], frame.status[pixel]);
                double& depth = mean.depth[size.frame.at(i / n, j)];
                if (possibly_hit(frame.status[pixel]))
                    depth = std::min(depth, midpoint(frame.t(pixel)));
            });
        }
        for (int i = 0; i < size.frame.width; ++i) {
            const auto column = static_cast<std::size_t>(i);
            const auto byte = [&](double sum) {
                return table.byte(static_cast<float>(sum * each));
            };
            mean.color[size.frame.at(i, j)] = {byte(sums[column].x), byte(sums[column].y),
                                               byte(sums[column].z), 255};
            ++mean.pixels[size.grid.tiles.at(i, j)][static_cast<std::size_t>(status[column])];
        }
    }
    return mean;
}

}  // namespace ivory
