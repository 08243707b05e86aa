// compare_pictures EXPECTED.png ACTUAL.png [--exact] [--difference OUT.png]
// compare_pictures --size PICTURE.png          prints WIDTHxHEIGHT
//
// Exit 0: equal, to the byte or within the tolerance of window pictures; 1: not, and one line says how
// far; 2: a file cannot be read. OUT.png shows where: the differences, eight times as strong, on black.
//
// The tolerance is for other processors and drivers than the baseline's, and for the milliseconds in the
// status bar: at most 0.5 % of the pixels differ, and 1 in 500 by more than 2/255 in a channel.
#include <png.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <optional>
#include <string>
#include <vector>

namespace {

struct Picture {
    int width = 0, height = 0;
    std::vector<std::uint8_t> rgb;
};

std::optional<Picture> read_picture(const char* path) {
    png_image image;
    std::memset(&image, 0, sizeof image);
    image.version = PNG_IMAGE_VERSION;
    if (png_image_begin_read_from_file(&image, path) == 0) {
        std::fprintf(stderr, "%s: %s\n", path, image.message);
        return std::nullopt;
    }
    image.format = PNG_FORMAT_RGB;
    Picture picture{static_cast<int>(image.width), static_cast<int>(image.height), {}};
    picture.rgb.resize(PNG_IMAGE_SIZE(image));
    if (png_image_finish_read(&image, nullptr, picture.rgb.data(), 0, nullptr) == 0) {
        std::fprintf(stderr, "%s: %s\n", path, image.message);
        return std::nullopt;
    }
    return picture;
}

bool write_picture(const char* path, const Picture& picture) {
    png_image image;
    std::memset(&image, 0, sizeof image);
    image.version = PNG_IMAGE_VERSION;
    image.width = static_cast<png_uint_32>(picture.width);
    image.height = static_cast<png_uint_32>(picture.height);
    image.format = PNG_FORMAT_RGB;
    return png_image_write_to_file(&image, path, 0, picture.rgb.data(), 0, nullptr) != 0;
}

struct Difference {
    std::size_t pixels = 0, visible_pixels = 0;  // that differ; by more than 2
    int greatest = 0;
};

Difference difference_of(const Picture& a, const Picture& b, Picture& shown) {
    Difference difference;
    shown = {a.width, a.height, std::vector<std::uint8_t>(a.rgb.size())};
    for (std::size_t p = 0; p < a.rgb.size(); p += 3) {
        int most = 0;
        for (std::size_t c = p; c < p + 3; ++c) {
            const int d = std::abs(a.rgb[c] - b.rgb[c]);
            shown.rgb[c] = static_cast<std::uint8_t>(std::min(8 * d, 255));
            most = std::max(most, d);
        }
        difference.pixels += most > 0;
        difference.visible_pixels += most > 2;
        difference.greatest = std::max(difference.greatest, most);
    }
    return difference;
}

}  // namespace

int main(int count, char** words) {
    std::vector<const char*> files;
    const char* difference_file = nullptr;
    bool exact = false, size = false;
    for (int i = 1; i < count; ++i) {
        if (std::strcmp(words[i], "--exact") == 0)
            exact = true;
        else if (std::strcmp(words[i], "--size") == 0)
            size = true;
        else if (std::strcmp(words[i], "--difference") == 0 && i + 1 < count)
            difference_file = words[++i];
        else
            files.push_back(words[i]);
    }
    if (files.size() != (size ? 1u : 2u)) {
        std::fprintf(stderr, "compare_pictures: two pictures, or --size and one\n");
        return 2;
    }
    const std::optional<Picture> expected = read_picture(files[0]);
    if (!expected) return 2;
    if (size) {
        std::printf("%dx%d\n", expected->width, expected->height);
        return 0;
    }
    const std::optional<Picture> actual = read_picture(files[1]);
    if (!actual) return 2;
    if (actual->width != expected->width || actual->height != expected->height) {
        std::fprintf(stderr, "%s is %dx%d, expected %dx%d\n", files[1], actual->width,
                     actual->height, expected->width, expected->height);
        return 1;
    }
    Picture shown;
    const Difference difference = difference_of(*expected, *actual, shown);
    const double all = static_cast<double>(expected->rgb.size() / 3);
    const bool equal = exact ? difference.pixels == 0
                             : static_cast<double>(difference.pixels) <= 0.005 * all &&
                                   static_cast<double>(difference.visible_pixels) <= all / 500;
    if (equal) return 0;
    std::fprintf(stderr,
                 "%s: %zu of %.0f pixels differ from %s, %zu of them by more than 2/255, at most "
                 "by %d/255\n",
                 files[1], difference.pixels, all, files[0], difference.visible_pixels,
                 difference.greatest);
    if (difference_file != nullptr && !write_picture(difference_file, shown))
        std::fprintf(stderr, "%s cannot be written\n", difference_file);
    return 1;
}
