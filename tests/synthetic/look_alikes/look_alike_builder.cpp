// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "tests/synthetic/look_alikes/look_alike_builder.h"

#include <algorithm>
#include <numeric>
#include <utility>

#include "tests/synthetic/disturb.h"
#include "tests/synthetic/rng.h"
#include "tests/synthetic/scene_feature.h"

namespace psfm::synthetic {
namespace {

/// Gives what is used numbers from 0 on, in ascending order; the rest stays without.
class Renumbering {
  public:
    explicit Renumbering(std::size_t count) : number_(count, kNoPoint) {}
    void use(std::uint32_t old) { number_[old] = 0; }
    /// @return how many are in use
    std::uint32_t assign() {
        std::uint32_t next = 0;
        for (std::uint32_t& number : number_) {
            if (number != kNoPoint) number = next++;
        }
        return next;
    }
    bool is_used(std::uint32_t old) const { return number_[old] != kNoPoint; }
    std::uint32_t operator()(std::uint32_t old) const { return number_[old]; }

  private:
    std::vector<std::uint32_t> number_;
};

/// Leaves out points that no image sees, and looks that no point has then.
void drop_unseen(LookAlikeScene& made, std::uint32_t looks) {
    Renumbering points(made.scene.points.size());
    for (const SceneImage& image : made.scene.images) {
        for (const std::uint32_t point : image.feature_point) points.use(point);
    }
    points.assign();
    Renumbering look(looks);
    std::uint32_t kept = 0;
    for (std::uint32_t i = 0; i < made.scene.points.size(); ++i) {
        if (!points.is_used(i)) continue;
        made.scene.points[kept] = made.scene.points[i];
        made.looks[kept] = made.looks[i];
        made.places[kept] = made.places[i];
        look.use(made.looks[kept]);
        ++kept;
    }
    made.scene.points.resize(kept);
    made.looks.resize(kept);
    made.places.resize(kept);
    made.look_count = look.assign();
    for (std::uint32_t& of_point : made.looks) of_point = look(of_point);
    for (SceneImage& image : made.scene.images) {
        for (std::uint32_t& point : image.feature_point) point = points(point);
    }
}

void sort_by_scale(SceneImage& image) {
    std::vector<std::uint32_t> order(image.keypoints.size());
    std::iota(order.begin(), order.end(), 0U);
    std::ranges::stable_sort(order, std::ranges::greater{},
                             [&](std::uint32_t i) { return image.keypoints[i].scale; });
    Keypoints keypoints;
    std::vector<std::uint32_t> points;
    for (const std::uint32_t i : order) {
        keypoints.push_back(image.keypoints[i]);
        points.push_back(image.feature_point[i]);
    }
    image.keypoints = std::move(keypoints);
    image.feature_point = std::move(points);
}

}  // namespace

LookAlikeBuilder::LookAlikeBuilder(std::uint64_t seed) : seed_(seed) {
    made_.scene.seed = seed;
}

CameraId LookAlikeBuilder::add_camera(const Camera& camera) {
    const auto id = static_cast<CameraId>(made_.scene.cameras.size());
    made_.scene.cameras.emplace(id, camera);
    field_of_view_.push_back(field_of_view(camera));
    return id;
}

std::uint32_t LookAlikeBuilder::add_place(const Rigid3& world_from_thing) {
    made_.world_from_thing.push_back(world_from_thing);
    return static_cast<std::uint32_t>(made_.world_from_thing.size() - 1);
}

ImageId LookAlikeBuilder::add_image(CameraId camera, const Rigid3& cam_from_world,
                                    std::string name) {
    const auto id = static_cast<ImageId>(made_.scene.images.size());
    made_.scene.images.push_back({camera, cam_from_world, {}, {}});
    made_.names.push_back(std::move(name));
    return id;
}

std::uint32_t LookAlikeBuilder::add_point(const SurfacePoint& point, std::uint32_t look,
                                          std::uint32_t place) {
    made_.scene.points.push_back(point);
    made_.looks.push_back(look);
    made_.places.push_back(place);
    return static_cast<std::uint32_t>(made_.scene.points.size() - 1);
}

void LookAlikeBuilder::observe(ImageId image, std::uint32_t point) {
    SceneImage& view = made_.scene.images[index_of(image)];
    const std::optional<Keypoint> feature =
        feature_of(made_.scene.cameras.at(view.camera), field_of_view_[index_of(view.camera)],
                   view.cam_from_world, made_.scene.points[point].position,
                   mix_seed(seed_, made_.looks[point]));
    if (!feature) return;
    view.keypoints.push_back(*feature);
    view.feature_point.push_back(point);
}

LookAlikeScene LookAlikeBuilder::finish(double noise_px) {
    LookAlikeScene made = std::exchange(made_, {});
    drop_unseen(made, std::exchange(look_count_, 0));
    for (SceneImage& image : made.scene.images) sort_by_scale(image);
    made.scene = add_pixel_noise(std::move(made.scene), noise_px, seed_);
    made.order.resize(made.names.size());
    std::iota(made.order.begin(), made.order.end(), std::size_t{0});
    return made;
}

std::vector<std::size_t> interleaved_order(const std::vector<std::uint32_t>& images_of_user,
                                           std::uint64_t seed) {
    const double longest = images_of_user.empty() ? 0.0 : std::ranges::max(images_of_user);
    std::vector<std::pair<double, std::size_t>> taken;  // time [s], image
    for (std::uint32_t user = 0; user < images_of_user.size(); ++user) {
        Rng rng(mix_seed(mix_seed(seed, 30), user));
        double time = rng.uniform(0.0, longest);
        for (std::uint32_t i = 0; i < images_of_user[user]; ++i) {
            taken.emplace_back(time, taken.size());
            time += rng.uniform(0.7, 1.3);
        }
    }
    std::ranges::sort(taken);
    std::vector<std::size_t> order;
    order.reserve(taken.size());
    for (const auto& [time, image] : taken) order.push_back(image);
    return order;
}

std::vector<std::size_t> order_by_stripe(const SyntheticScene& scene,
                                         const std::vector<std::size_t>& order,
                                         std::size_t images_of_stripe) {
    std::vector<std::pair<double, std::size_t>> along;
    for (std::size_t i = 0; i < scene.images.size(); ++i)
        along.emplace_back(scene.images[i].cam_from_world.target_origin_in_source().x(), i);
    std::ranges::sort(along);
    std::vector<std::size_t> stripe(along.size());
    for (std::size_t rank = 0; rank < along.size(); ++rank)
        stripe[along[rank].second] = rank / images_of_stripe;
    std::vector<std::size_t> by_stripe = order;
    std::ranges::stable_sort(by_stripe, {}, [&](std::size_t image) { return stripe[image]; });
    return by_stripe;
}

std::string image_name(const std::string& prefix, std::uint32_t index, std::uint32_t count) {
    const std::size_t digits =
        std::max<std::size_t>(4, std::to_string(std::max(count, 1U) - 1).size());
    const std::string number = std::to_string(index);
    return prefix + '_' + std::string(digits - number.size(), '0') + number + ".jpg";
}

}  // namespace psfm::synthetic
