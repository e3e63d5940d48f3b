// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/reconstruction/checks/camera_ties.h"

#include <algorithm>
#include <cstdint>
#include <iterator>
#include <utility>
#include <vector>

#include "graph/camera_lens.h"
#include "stages/algorithms/math/median.h"

namespace psfm {
namespace {

using Size = std::pair<std::uint32_t, std::uint32_t>;

Size size_of(const Camera& camera) {
    return {camera.width, camera.height};
}

const ClusterImage* find_member(const ClusterProblem& problem, ImageId id) {
    const auto found = std::ranges::lower_bound(problem.images, id, {}, &ClusterImage::id);
    return found != problem.images.end() && found->id == id ? &*found : nullptr;
}

/// Cameras of one kind that a model has for one, and how many of its images.
struct Tie {
    std::vector<CameraId> members;  ///< as accepted
    std::size_t images = 0;
};

bool have_one_lens(const Camera& a, const Camera& b) {
    return size_of(a) != size_of(b) && with_lens_of(a, b).params == a.params && a.model == b.model;
}

/// What a model has of some cameras, by the one that stands for them. @param cameras  ascending
std::map<CameraId, Tie> ties_in(const Reconstruction& model, const ClusterProblem& problem,
                                const std::vector<CameraId>& cameras) {
    std::map<CameraId, Tie> ties;
    for (const RegisteredImage& image : model.images) {
        const ClusterImage* member = find_member(problem, image.image);
        if (!member || !std::ranges::binary_search(cameras, member->camera)) continue;
        Tie& tie = ties[image.camera];
        ++tie.images;
        if (std::ranges::find(tie.members, member->camera) == tie.members.end())
            tie.members.push_back(member->camera);
    }
    for (auto first = ties.begin(); first != ties.end(); ++first) {
        for (auto second = std::next(first); second != ties.end(); ++second) {
            if (!have_one_lens(model.cameras.at(first->first), model.cameras.at(second->first)))
                continue;
            first->second.images += second->second.images;
            first->second.members.insert(first->second.members.end(),
                                         second->second.members.begin(),
                                         second->second.members.end());
            ties.erase(second);
            break;
        }
    }
    return ties;
}

void tie(std::vector<CameraId> cameras, const ClusterProblem& problem, CameraTies& ties) {
    std::ranges::sort(cameras);
    std::map<Size, CameraId> first_of_size;
    for (const CameraId camera : cameras) {
        const Size size = size_of(problem.cameras.at(camera));
        const auto [first, is_new] = first_of_size.try_emplace(size, camera);
        ties.standing[camera] = first->second;
        if (is_new && camera != cameras.front()) ties.twins[camera] = cameras.front();
    }
}

std::map<std::uint32_t, std::vector<CameraId>> cameras_by_kind(const ClusterProblem& problem) {
    std::map<std::uint32_t, std::vector<CameraId>> kinds;
    for (const auto& [camera, kind] : problem.alike) kinds[kind].push_back(camera);
    return kinds;
}

/// Ties the cameras of one kind as the recycled models have them. @param cameras  ascending
void tie_kind(const ClusterProblem& problem, std::vector<CameraId> cameras, CameraTies& ties) {
    std::vector<CameraId> main;
    bool any_placed = false;
    // The largest model comes first and has the first word.
    for (const auto& model : problem.recycled) {
        std::map<CameraId, Tie> of_model = ties_in(*model, problem, cameras);
        any_placed |= !of_model.empty();
        for (const auto& [standing, known] : of_model) {
            for (const CameraId member : known.members) std::erase(cameras, member);
        }
        std::erase_if(of_model, [](const auto& t) { return t.second.members.size() < 2; });
        const auto largest =
            std::ranges::max_element(of_model, {}, [](const auto& t) { return t.second.images; });
        for (auto t = of_model.begin(); t != of_model.end(); ++t) {
            if (t == largest) {
                main.insert(main.end(), t->second.members.begin(), t->second.members.end());
            } else {
                tie(t->second.members, problem, ties);
            }
        }
    }
    if (!any_placed || !main.empty()) main.insert(main.end(), cameras.begin(), cameras.end());
    if (!main.empty()) tie(std::move(main), problem, ties);
}

/// Of the cameras that images were taken with, each once an image.
const Camera& middle_of(std::vector<const Camera*> cameras) {
    return *upper_median(std::move(cameras), [](const Camera* c) { return c->mean_focal(); });
}

}  // namespace

CameraTies untied(const ClusterProblem& problem) {
    CameraTies ties;
    for (const auto& [id, camera] : problem.cameras) ties.standing[id] = id;
    return ties;
}

CameraTies all_tied(const ClusterProblem& problem) {
    CameraTies ties = untied(problem);
    for (auto& [kind, cameras] : cameras_by_kind(problem)) tie(std::move(cameras), problem, ties);
    return ties;
}

CameraTies ties_of(const std::map<CameraId, std::size_t>& labels, const ClusterProblem& problem) {
    std::map<std::size_t, std::vector<CameraId>> members;
    for (const auto& [own, label] : labels) members[label].push_back(own);
    CameraTies ties = untied(problem);
    for (auto& [label, cameras] : members) tie(std::move(cameras), problem, ties);
    return ties;
}

std::map<CameraId, std::size_t> labels_of(const CameraTies& ties) {
    std::map<CameraId, std::size_t> label_of_lens;
    std::map<CameraId, std::size_t> labels;
    for (const auto& [own, standing] : ties.standing) {
        const auto twin = ties.twins.find(standing);
        const CameraId lens = twin == ties.twins.end() ? standing : twin->second;
        labels[own] = label_of_lens.try_emplace(lens, label_of_lens.size()).first->second;
    }
    return labels;
}

CameraTies recycled_ties(const ClusterProblem& problem) {
    CameraTies ties = untied(problem);
    for (auto& [kind, cameras] : cameras_by_kind(problem))
        tie_kind(problem, std::move(cameras), ties);
    return ties;
}

std::shared_ptr<const Reconstruction> with_ties(const std::shared_ptr<const Reconstruction>& model,
                                                const ClusterProblem& problem,
                                                const CameraTies& ties) {
    auto result = std::make_shared<Reconstruction>(*model);
    std::map<CameraId, std::vector<const Camera*>> become;
    std::map<CameraId, std::vector<const Camera*>> lenses;
    for (RegisteredImage& image : result->images) {
        const Camera& camera = model->cameras.at(image.camera);
        if (const ClusterImage* member = find_member(problem, image.image))
            image.camera = ties.standing.at(member->camera);
        become[image.camera].push_back(&camera);
        const auto twin = ties.twins.find(image.camera);
        lenses[twin == ties.twins.end() ? image.camera : twin->second].push_back(&camera);
    }
    result->cameras.clear();
    for (const auto& [id, cameras] : become) result->cameras[id] = middle_of(cameras);
    for (const auto& [twin, camera] : ties.twins) {
        if (!become.contains(twin)) continue;
        const Camera lens = middle_of(lenses.at(camera));
        result->cameras[twin] = with_lens_of(result->cameras.at(twin), lens);
        if (become.contains(camera))
            result->cameras[camera] = with_lens_of(result->cameras.at(camera), lens);
    }
    const bool same = result->cameras == model->cameras &&
                      std::ranges::equal(result->images, model->images, {},
                                         &RegisteredImage::camera, &RegisteredImage::camera);
    return same ? model : result;
}

ClusterProblem tied(const ClusterProblem& problem, const CameraTies& ties) {
    ClusterProblem result = problem;
    const auto by_standing = [&](const std::map<CameraId, Camera>& cameras) {
        std::map<CameraId, Camera> standing;
        for (const auto& [own, camera] : cameras)
            standing.try_emplace(ties.standing.at(own), camera);
        return standing;
    };
    for (ClusterImage& image : result.images) image.camera = ties.standing.at(image.camera);
    result.cameras = by_standing(problem.cameras);
    result.calibrated = by_standing(problem.calibrated);
    result.twins = ties.twins;
    for (auto& model : result.recycled) model = with_ties(model, problem, ties);
    return result;
}

}  // namespace psfm
