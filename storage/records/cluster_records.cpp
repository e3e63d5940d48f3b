// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "storage/records/cluster_records.h"

#include <algorithm>
#include <cstring>
#include <functional>

#include "storage/records/compact_list.h"
#include "storage/records/flat_payload.h"
#include "storage/records/generated/records_generated.h"

namespace psfm {
namespace {

const char* problem_of(const StoredCluster& cluster) {
    if (cluster.members.empty()) return "cluster has no members";
    if (!strictly_ascending(cluster.members)) return "cluster members are not ascending";
    if (!strictly_ascending(cluster.adopted)) return "adopted images are not ascending";
    if (std::ranges::any_of(cluster.adopted, [&](ImageId image) {
            return std::ranges::binary_search(cluster.members, image);
        })) {
        return "cluster has adopted a member";
    }
    if (std::ranges::adjacent_find(cluster.apart, std::greater_equal<>{}) != cluster.apart.end() ||
        std::ranges::any_of(cluster.apart, [&](const ImagePair& pair) {
            return pair.first >= pair.second ||
                   !std::ranges::binary_search(cluster.members, pair.first);
        })) {
        return "pairs of different places are not ascending, or not of its members";
    }
    if (cluster.solved_topology > cluster.topology ||
        cluster.transfer_topology > cluster.topology) {
        return "cluster was solved for a topology to come";
    }
    return nullptr;
}

}  // namespace

Result<std::string> encode_cluster(const ClusterRecord& record) {
    const StoredCluster& cluster = record.cluster;
    if (const char* problem = problem_of(cluster)) {
        return not_storable("cluster " + std::to_string(index_of(cluster.id)) + ": " + problem);
    }
    flatbuffers::FlatBufferBuilder builder;
    const auto members = builder.CreateVector(encode_members(cluster.members));
    std::vector<std::uint32_t> numbers;
    for (const SolutionReference& solution : cluster.recycled) {
        numbers.push_back(index_of(solution.cluster));
        numbers.push_back(solution.revision);
    }
    const auto recycled = numbers.empty()
                              ? flatbuffers::Offset<flatbuffers::Vector<std::uint32_t>>()
                              : builder.CreateVector(numbers);
    const auto adopted = cluster.adopted.empty()
                             ? flatbuffers::Offset<flatbuffers::Vector<std::uint8_t>>()
                             : builder.CreateVector(encode_members(cluster.adopted));
    numbers.clear();
    for (const ImagePair& pair : cluster.apart) {
        numbers.push_back(index_of(pair.first));
        numbers.push_back(index_of(pair.second));
    }
    const auto apart = numbers.empty() ? flatbuffers::Offset<flatbuffers::Vector<std::uint32_t>>()
                                       : builder.CreateVector(numbers);
    builder.Finish(records::CreateCluster(builder, members, cluster.topology,
                                          cluster.solved_topology, cluster.revision, record.removed,
                                          cluster.transfer_topology, recycled, adopted, apart,
                                          record.whole, cluster.abandoned, cluster.at_rest));
    return finished(builder);
}

Result<ClusterRecord> decode_cluster(ClusterId id, std::string_view payload) {
    const FlatPayload flat(payload);
    const auto* record = flat.root<records::Cluster>();
    if (record == nullptr) return damaged_payload(kNotATable);
    auto members = decode_members(bytes_of(*record->members()));
    if (!members) return damaged_payload("list of members is broken");
    ClusterRecord result{{id,
                          std::move(*members),
                          record->topology(),
                          record->solved_topology(),
                          record->revision(),
                          record->transfer_topology(),
                          {},
                          {},
                          {},
                          record->abandoned(),
                          record->at_rest()},
                         record->removed(),
                         record->whole()};
    if (const auto* recycled = record->recycled()) {
        if (recycled->size() % 2 != 0) return damaged_payload("list of recycled models is broken");
        for (flatbuffers::uoffset_t i = 0; i < recycled->size(); i += 2) {
            result.cluster.recycled.push_back(
                {static_cast<ClusterId>(recycled->Get(i)), recycled->Get(i + 1)});
        }
    }
    if (const auto* adopted = record->adopted()) {
        auto images = decode_members(bytes_of(*adopted));
        if (!images) return damaged_payload("list of adopted images is broken");
        result.cluster.adopted = std::move(*images);
    }
    if (const auto* apart = record->apart()) {
        if (apart->size() % 2 != 0) return damaged_payload("list of pairs apart is broken");
        for (flatbuffers::uoffset_t i = 0; i < apart->size(); i += 2) {
            result.cluster.apart.push_back(
                {static_cast<ImageId>(apart->Get(i)), static_cast<ImageId>(apart->Get(i + 1))});
        }
    }
    if (const char* problem = problem_of(result.cluster)) return damaged_payload(problem);
    if (result.whole > result.cluster.revision)
        return damaged_payload("its latest solution builds on one to come");
    return result;
}

std::string encode_superseded(const SolutionKey& key, std::uint32_t whole) {
    if (whole == key.revision) return {};
    std::string payload(sizeof(whole), '\0');
    std::memcpy(payload.data(), &whole, sizeof(whole));
    return payload;
}

Result<std::uint32_t> decode_superseded(const SolutionKey& key, std::string_view payload) {
    if (payload.empty()) return key.revision;
    std::uint32_t whole = 0;
    if (payload.size() != sizeof(whole)) return damaged_payload("has another size than it should");
    std::memcpy(&whole, payload.data(), sizeof(whole));
    if (whole == 0 || whole >= key.revision)
        return damaged_payload("its solution builds on one to come");
    return whole;
}

std::uint32_t whole_revision(const ClusterRecord& record) {
    return record.whole == 0 ? record.cluster.revision : record.whole;
}

}  // namespace psfm
