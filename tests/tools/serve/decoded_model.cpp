// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "tests/tools/serve/decoded_model.h"

#include <cstring>
#include <stdexcept>
#include <vector>

namespace psfm::testing {
namespace {

class Bytes {
  public:
    explicit Bytes(std::string_view bytes) : bytes_(bytes) {}
    bool empty() const { return at_ == bytes_.size(); }
    template <typename T>
    T read() {
        T value{};
        const std::string_view taken = take(sizeof(T));
        std::memcpy(&value, taken.data(), sizeof(T));
        return value;
    }
    std::uint32_t leb() {
        std::uint32_t value = 0;
        for (unsigned shift = 0;; shift += 7) {
            const auto byte = read<std::uint8_t>();
            value |= static_cast<std::uint32_t>(byte & 0x7fU) << shift;
            if (byte < 0x80) return value;
        }
    }
    std::string_view take(std::size_t count) {
        if (count > bytes_.size() - at_) throw std::runtime_error("a change ends too early");
        at_ += count;
        return bytes_.substr(at_ - count, count);
    }
    std::vector<std::uint32_t> ascending(std::uint32_t count) {
        std::vector<std::uint32_t> values;
        std::uint32_t before = 0;
        for (std::uint32_t i = 0; i < count; ++i) values.push_back(before += leb());
        return values;
    }
    Sim3 similarity() {
        Sim3 value;
        value.scale = read<float>();
        for (double& part : value.rotation.coeffs()) part = read<float>();
        for (double& part : value.translation) part = read<float>();
        return value;
    }
    std::vector<Eigen::Vector3d> positions(std::size_t count) {
        Eigen::Vector3d origin;
        for (double& part : origin) part = read<float>();
        const double step = static_cast<double>(read<float>()) / 65535.0;
        std::vector<Eigen::Vector3d> all(count);
        for (int axis = 0; axis < 3; ++axis) {
            const std::string_view low = take(count);
            const std::string_view high = take(count);
            std::uint16_t value = 0;
            for (std::size_t i = 0; i < count; ++i) {
                const unsigned difference =
                    static_cast<unsigned char>(low[i]) + 256U * static_cast<unsigned char>(high[i]);
                value = static_cast<std::uint16_t>(value + difference);
                all[i][axis] = origin[axis] + step * value;
            }
        }
        return all;
    }

  private:
    std::string_view bytes_;
    std::size_t at_ = 0;
};

}  // namespace

void DecodedModel::apply(std::string_view change) {
    Bytes bytes(change);
    if (bytes.take(4) != "PSC1") throw std::runtime_error("no change");
    number = bytes.read<std::uint32_t>();
    version = bytes.read<std::uint64_t>();
    bytes.read<std::uint32_t>();
    while (!bytes.empty()) {
        const auto id = bytes.read<std::uint32_t>();
        const auto kind = bytes.read<std::uint8_t>();
        Bytes part(bytes.take(bytes.read<std::uint32_t>()));
        Cluster& cluster = clusters[id];
        ++parts;
        if (kind == 1) {
            cluster.place = part.similarity();
            cluster.part = part.read<std::uint32_t>();
        } else if (kind == 2 || kind == 3) {
            const auto slots = part.ascending(part.read<std::uint32_t>());
            const auto positions = part.positions(slots.size());
            for (std::size_t i = 0; i < slots.size(); ++i)
                cluster.points[slots[i]].position = positions[i];
            (kind == 2 ? points_put : points_moved) += slots.size();
            if (kind == 2) {
                part.take(5 * slots.size());
                for (const std::uint32_t slot : slots) cluster.points[slot].born = part.leb();
                for (std::size_t i = 0; i < slots.size(); ++i) part.leb();
                if (!part.empty()) throw std::runtime_error("bytes behind points");
            }
        } else if (kind == 4) {
            for (const std::uint32_t slot : part.ascending(part.read<std::uint32_t>()))
                cluster.points.erase(slot);
        } else if (kind == 5) {
            for (auto n = part.read<std::uint32_t>(); n > 0; --n) {
                const auto image = part.read<std::uint32_t>();
                part.take(5 * sizeof(std::uint32_t));
                Eigen::Vector3d centre;
                for (double& value : centre) value = part.read<float>();
                cluster.cameras[image] = centre;
            }
        } else if (kind == 6) {
            Cluster& target = clusters[part.read<std::uint32_t>()];
            const Sim3 target_from_source = part.similarity();
            auto slot = part.read<std::uint32_t>();
            for (const std::uint32_t from : part.ascending(part.read<std::uint32_t>())) {
                Point point = cluster.points.at(from);
                point.position = target_from_source * point.position;
                target.points[slot++] = point;
                cluster.points.erase(from);
            }
            for (auto n = part.read<std::uint32_t>(); n > 0; --n) {
                const auto image = part.read<std::uint32_t>();
                target.cameras[image] = target_from_source * cluster.cameras.at(image);
                cluster.cameras.erase(image);
            }
        } else if (kind == 7) {
            clusters.erase(id);
        } else if (kind == 8) {
            for (auto n = part.read<std::uint32_t>(); n > 0; --n)
                cluster.cameras.erase(part.read<std::uint32_t>());
        }
    }
}

}  // namespace psfm::testing
