// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "graph/undistorted_view.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>

namespace psfm {
namespace {

/// Guard: places looked at along each side of a photograph or picture. Sides are smooth between
/// them.
constexpr int kSamples = 32;

/// A rectangle of normalised coordinates about the optical axis: left, top < 0 < right, bottom.
struct Window {
    double left = 0.0;
    double top = 0.0;
    double right = 0.0;
    double bottom = 0.0;
};

Eigen::Vector2d turn(const Eigen::Vector2d& x, std::uint8_t quarter_turns) {
    switch (quarter_turns) {
        case 1:
            return {-x.y(), x.x()};
        case 2:
            return -x;
        case 3:
            return {x.y(), -x.x()};
        default:
            return x;
    }
}

std::uint8_t opposite(std::uint8_t quarter_turns) {
    return static_cast<std::uint8_t>((4U - quarter_turns) % 4U);
}

/// Whether distortion keeps its sense from the axis out to here: beyond a fold it shows what lies
/// further in a second time.
bool is_regular(const Camera& camera, const Eigen::Vector2d& normalized) {
    // Mathematics: of central differences of numbers about 1, where rounding and curvature err by
    // 1e-10.
    constexpr double kStep = 1e-6;
    const double scale = camera.fx() * camera.fy();
    for (int k = 1; k <= 8; ++k) {
        const Eigen::Vector2d x = normalized * (k / 8.0);
        Eigen::Matrix2d jacobian;
        for (int axis = 0; axis < 2; ++axis) {
            const Eigen::Vector2d step = Eigen::Vector2d::Unit(axis) * kStep;
            jacobian.col(axis) = (pixel_from_normalized(camera, x + step) -
                                  pixel_from_normalized(camera, x - step)) /
                                 (2 * kStep);
        }
        if (!(jacobian.determinant() > 1e-3 * scale)) return false;
    }
    return true;
}

bool is_inside(const Camera& camera, const Eigen::Vector2d& pixel) {
    constexpr double kRounding = 1e-6;  // Guard: [px], rounding of places on the rim
    return pixel.x() >= -kRounding && pixel.y() >= -kRounding &&
           pixel.x() <= camera.width + kRounding && pixel.y() <= camera.height + kRounding;
}

/// Whether every place on a window's border can be had from the photograph.
bool is_available(const Camera& camera, const Window& window, bool inside) {
    const auto good = [&](double x, double y) {
        const Eigen::Vector2d place(x, y);
        return is_regular(camera, place) &&
               (!inside || is_inside(camera, pixel_from_normalized(camera, place)));
    };
    for (int k = 0; k <= kSamples; ++k) {
        const double part = static_cast<double>(k) / kSamples;
        const double x = std::lerp(window.left, window.right, part);
        const double y = std::lerp(window.top, window.bottom, part);
        if (!good(x, window.top) || !good(x, window.bottom) || !good(window.left, y) ||
            !good(window.right, y)) {
            return false;
        }
    }
    return true;
}

Window operator*(double factor, const Window& window) {
    return {factor * window.left, factor * window.top, factor * window.right,
            factor * window.bottom};
}

struct Windows {
    Window inner;  ///< inside of all four sides
    Window outer;  ///< with all four sides inside
};

/// What the photograph's sides leave, where they can be undistorted at all.
Windows windows_of(const Camera& camera) {
    // Guard: where a side cannot be undistorted, some bound all the same.
    constexpr double kFar = 1e3;
    Windows windows{{-kFar, -kFar, kFar, kFar}, {0.0, 0.0, 0.0, 0.0}};
    const auto look = [&](double px, double py, auto&& narrow) {
        const Eigen::Vector2d pixel(px, py);
        const Eigen::Vector2d place = normalized_from_pixel(camera, pixel);
        if ((pixel_from_normalized(camera, place) - pixel).norm() > 1e-3 ||
            !is_regular(camera, place)) {
            return;
        }
        narrow(place);
        Window& outer = windows.outer;
        outer.left = std::min(outer.left, place.x());
        outer.right = std::max(outer.right, place.x());
        outer.top = std::min(outer.top, place.y());
        outer.bottom = std::max(outer.bottom, place.y());
    };
    Window& inner = windows.inner;
    for (int k = 0; k <= kSamples; ++k) {
        const double px = camera.width * static_cast<double>(k) / kSamples;
        const double py = camera.height * static_cast<double>(k) / kSamples;
        look(0.0, py, [&](const auto& place) { inner.left = std::max(inner.left, place.x()); });
        look(camera.width, py,
             [&](const auto& place) { inner.right = std::min(inner.right, place.x()); });
        look(px, 0.0, [&](const auto& place) { inner.top = std::max(inner.top, place.y()); });
        look(px, camera.height,
             [&](const auto& place) { inner.bottom = std::min(inner.bottom, place.y()); });
    }
    return windows;
}

Window centred(const Window& window) {
    const double x = std::min(-window.left, window.right);
    const double y = std::min(-window.top, window.bottom);
    return {-x, -y, x, y};
}

Window between(const Window& inner, const Window& outer, double part) {
    return {std::lerp(inner.left, outer.left, part), std::lerp(inner.top, outer.top, part),
            std::lerp(inner.right, outer.right, part), std::lerp(inner.bottom, outer.bottom, part)};
}

/// The largest part of a window, of the same shape, that the photograph has.
Result<Window> available_part(const Camera& camera, const Window& window, bool inside) {
    // Guard: lenses leave nine tenths of the window; what leaves less than a fifth is no lens.
    constexpr double kLeast = 0.2;
    // Guard: bounds the steps; pictures are up to half a per cent smaller than could be.
    constexpr double kStep = 0.995;
    if (window.left < 0 && window.top < 0 && window.right > 0 && window.bottom > 0) {
        for (double factor = 1.0; factor > kLeast; factor *= kStep) {
            if (is_available(camera, factor * window, inside)) return factor * window;
        }
    }
    return Error{ErrorCode::kInvalidArgument,
                 "the distortion of a camera of " + std::to_string(camera.width) + "x" +
                     std::to_string(camera.height) +
                     " pixels cannot be undone: its photographs were too few to calibrate it; add "
                     "more of them, or give its intrinsics with --cameras"};
}

std::uint32_t whole_pixels(double length, std::uint32_t multiple) {
    constexpr double kRounding = 1e-6;  // Guard: [px], rounding must not cost a pixel
    const auto pixels = static_cast<std::uint32_t>(std::max(0.0, length + kRounding));
    return std::max(pixels / multiple * multiple, multiple);
}

}  // namespace

Result<UndistortedView> make_undistorted_view(const Camera& photo, std::uint8_t quarter_turns,
                                              const UndistortedViewOptions& options) {
    if (!(options.blank_pixels >= 0.0 && options.blank_pixels <= 1.0) || options.multiple == 0 ||
        quarter_turns > 3) {
        return Error{ErrorCode::kInvalidArgument, "blank_pixels is 0 to 1, multiple at least 1"};
    }
    if (auto valid = validate(photo); !valid.ok()) return valid.error();
    const Windows windows = windows_of(photo);
    const bool inside = options.blank_pixels == 0.0;
    Window wanted = between(windows.inner, windows.outer, options.blank_pixels);
    if (options.centred) wanted = centred(wanted);
    const auto window = available_part(photo, wanted, inside);
    if (!window.ok()) return window.error();

    double scale = 1.0;
    const double width = (window->right - window->left) * photo.fx();
    const double height = (window->bottom - window->top) * photo.fy();
    if (options.max_size > 0) scale = std::min(1.0, options.max_size / std::max(width, height));
    if (options.multiple > scale * std::min(width, height)) {
        return Error{ErrorCode::kInvalidArgument,
                     "a picture would have " + std::to_string(std::lround(scale * width)) + "x" +
                         std::to_string(std::lround(scale * height)) +
                         " pixels, and its sides are to be multiples of " +
                         std::to_string(options.multiple) + ": ask for smaller reductions"};
    }
    Camera stored;  // before the turn
    stored.model = CameraModel::kPinhole;
    stored.width = whole_pixels(scale * width, options.multiple);
    stored.height = whole_pixels(scale * height, options.multiple);
    const double fx = scale * photo.fx();
    const double fy = scale * photo.fy();
    const double cx = options.centred ? 0.5 * stored.width : -window->left * fx;
    const double cy = options.centred ? 0.5 * stored.height : -window->top * fy;

    UndistortedView view{photo, stored, quarter_turns};
    if (quarter_turns % 2 == 1) std::swap(view.picture.width, view.picture.height);
    const std::array<double, 8> as_stored{fx, fy, cx, cy};
    const std::array<double, 8> right{fy, fx, stored.height - cy, cx};
    const std::array<double, 8> half{fx, fy, stored.width - cx, stored.height - cy};
    const std::array<double, 8> left{fy, fx, cy, stored.width - cx};
    view.picture.params =
        std::array{as_stored, right, half, left}.at(quarter_turns);  // NOLINT(readability-*)
    view.picture.focal_source = photo.focal_source;
    return view;
}

std::uint8_t upright_quarter_turns(std::uint8_t orientation) {
    switch (orientation) {
        case 3:
        case 4:
            return 2;  // row 0 is at the bottom
        case 5:
        case 6:
            return 1;  // column 0 is at the top
        case 7:
        case 8:
            return 3;  // column 0 is at the bottom
        default:
            return 0;
    }
}

Eigen::Vector2d photo_from_picture(const UndistortedView& view, const Eigen::Vector2d& picture) {
    const Eigen::Vector2d offset = picture - view.picture.principal_point();
    const Eigen::Vector2d turned(offset.x() / view.picture.fx(), offset.y() / view.picture.fy());
    return pixel_from_normalized(view.photo, turn(turned, opposite(view.quarter_turns)));
}

Eigen::Vector2d picture_from_photo(const UndistortedView& view, const Eigen::Vector2d& photo) {
    return pixel_from_normalized(
        view.picture, turn(normalized_from_pixel(view.photo, photo), view.quarter_turns));
}

Rigid3 turned_pose(const Rigid3& cam_from_world, std::uint8_t quarter_turns) {
    // Quaternions of whole quarters about the optical axis, without rounding.
    const double half = std::sqrt(0.5);
    switch (quarter_turns) {
        case 1:
            return Rigid3{Eigen::Quaterniond(half, 0, 0, half), Eigen::Vector3d::Zero()} *
                   cam_from_world;
        case 2:
            return Rigid3{Eigen::Quaterniond(0, 0, 0, 1), Eigen::Vector3d::Zero()} * cam_from_world;
        case 3:
            return Rigid3{Eigen::Quaterniond(half, 0, 0, -half), Eigen::Vector3d::Zero()} *
                   cam_from_world;
        default:
            return cam_from_world;
    }
}

double largest_difference_px(const UndistortedView& view, const Camera& photo,
                             std::uint8_t quarter_turns) {
    if (view.quarter_turns != quarter_turns || view.photo.width != photo.width ||
        view.photo.height != photo.height) {
        return std::numeric_limits<double>::infinity();
    }
    // Guard: bounds the places that are looked at; distortions are smooth between.
    constexpr int kGrid = 16;
    const UndistortedView other{photo, view.picture, quarter_turns};
    double largest = 0.0;
    for (int row = 0; row <= kGrid; ++row) {
        for (int column = 0; column <= kGrid; ++column) {
            const Eigen::Vector2d place(view.picture.width * static_cast<double>(column) / kGrid,
                                        view.picture.height * static_cast<double>(row) / kGrid);
            largest = std::max(
                largest,
                (photo_from_picture(view, place) - photo_from_picture(other, place)).norm());
        }
    }
    return largest;
}

bool is_identity(const UndistortedView& view) {
    constexpr double kNothing = 1e-6;  // Guard: [px], rounding of both ways
    if (view.quarter_turns != 0 || view.picture.width != view.photo.width ||
        view.picture.height != view.photo.height) {
        return false;
    }
    for (const double x : {0.0, 0.25, 1.0}) {
        for (const double y : {0.0, 0.5, 1.0}) {
            const Eigen::Vector2d place(x * view.picture.width, y * view.picture.height);
            if ((photo_from_picture(view, place) - place).norm() > kNothing) return false;
        }
    }
    return true;
}

}  // namespace psfm
