// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/verification/run_verification.h"

#include <algorithm>
#include <chrono>
#include <exception>
#include <iterator>
#include <optional>
#include <set>
#include <string>
#include <tuple>
#include <utility>

#include "stages/algorithms/math/in_parallel.h"
#include "stages/algorithms/two_view/invert_two_view_geometry.h"
#include "stages/verification/verify_pair.h"

namespace psfm {
namespace {

using Clock = std::chrono::steady_clock;

double milliseconds_since(Clock::time_point start) {
    return std::chrono::duration<double, std::milli>(Clock::now() - start).count();
}

/// SplitMix64's finaliser (Steele, Lea & Flood, OOPSLA 2014).
std::uint64_t mix(std::uint64_t x) {
    x += 0x9e3779b97f4a7c15U;
    x = (x ^ (x >> 30U)) * 0xbf58476d1ce4e5b9U;
    x = (x ^ (x >> 27U)) * 0x94d049bb133111ebU;
    return x ^ (x >> 31U);
}

bool comes_first(const ImageFeatures& a, const ImageFeatures& b) {
    return std::tuple(a.content_hash, a.id) < std::tuple(b.content_hash, b.id);
}

Result<void> check(const ImageFeatures& image) {
    if (!image.keypoints || !image.descriptors ||
        image.keypoints->size() != image.descriptors->rows()) {
        return Error{ErrorCode::kInvalidArgument,
                     "image " + std::to_string(index_of(image.id)) +
                         " has no features, or not one descriptor a keypoint"};
    }
    return {};
}

std::vector<ImageId> without_repetitions(const std::vector<ImageId>& images) {
    std::set<ImageId> seen;
    std::vector<ImageId> once;
    std::ranges::copy_if(images, std::back_inserter(once),
                         [&](ImageId image) { return seen.insert(image).second; });
    return once;
}

enum class Outcome {
    kVerified,
    kStillOnly,
    kTooFewStrongest,
    kTooFewMatches,
    kDegenerate,
    kFailed
};

/// What came of one candidate.
struct Attempt {
    Outcome outcome = Outcome::kFailed;
    VerifiedPairPtr pair;
    Error error;
    std::size_t putative_matches = 0;
    double match_ms = 0.0;
    double verify_ms = 0.0;
};

Attempt failed(Error error) {
    Attempt attempt;
    attempt.error = std::move(error);
    return attempt;
}

Attempt attempt_pair(const VerificationInput& input, const PreparedDescriptors& prepared,
                     ImageId candidate_id, const VerificationOptions& options) {
    const Result<ImageFeatures> loaded = input.load(candidate_id);
    if (!loaded.ok()) return failed(loaded.error());
    const ImageFeatures& candidate = *loaded;
    if (const Result<void> valid = check(candidate); !valid.ok()) return failed(valid.error());

    Attempt attempt;
    Clock::time_point start = Clock::now();
    const std::optional<std::vector<FeatureMatch>> matches =
        match_images(*candidate.descriptors, *input.image.descriptors, prepared,
                     comes_first(candidate, input.image), options.match, options.cells);
    attempt.match_ms = milliseconds_since(start);
    if (!matches) {
        attempt.outcome = Outcome::kTooFewStrongest;
        return attempt;
    }
    attempt.putative_matches = matches->size();

    start = Clock::now();
    Result<TwoViewGeometry> geometry =
        verify_images(candidate, input.image, *matches, options.verify, input.seed);
    attempt.verify_ms = milliseconds_since(start);
    if (!geometry.ok()) {
        const ErrorCode code = geometry.error().code;
        if (code == ErrorCode::kTooFewMatches) {
            attempt.outcome = Outcome::kTooFewMatches;
        } else if (code == ErrorCode::kDegenerate) {
            attempt.outcome = Outcome::kDegenerate;
        } else {
            attempt.error = geometry.error();
        }
        return attempt;
    }
    VerifiedPair pair{ImagePair::of(candidate_id, input.image.id), std::move(*geometry)};
    if (pair.pair.first != candidate_id) pair.geometry = invert(pair.geometry);
    attempt.outcome = is_still_only(pair.geometry) ? Outcome::kStillOnly : Outcome::kVerified;
    attempt.pair = std::make_shared<const VerifiedPair>(std::move(pair));
    return attempt;
}

Attempt attempt_pair_catching(const VerificationInput& input, const PreparedDescriptors& prepared,
                              ImageId candidate_id, const VerificationOptions& options) {
    try {
        return attempt_pair(input, prepared, candidate_id, options);
    } catch (const std::exception& exception) {
        return failed({ErrorCode::kInternal,
                       "verifying images " + std::to_string(index_of(candidate_id)) + " and " +
                           std::to_string(index_of(input.image.id)) + ": " + exception.what()});
    }
}

void count(const Attempt& attempt, VerificationStatistics& statistics) {
    ++statistics.tried;
    statistics.putative_matches += attempt.putative_matches;
    statistics.match_ms += attempt.match_ms;
    statistics.verify_ms += attempt.verify_ms;
    switch (attempt.outcome) {
        case Outcome::kVerified:
            ++statistics.verified;
            statistics.inliers += attempt.pair->geometry.inliers.size();
            break;
        case Outcome::kStillOnly:
            ++statistics.still_only;
            break;
        case Outcome::kTooFewStrongest:
            ++statistics.too_few_strongest;
            break;
        case Outcome::kTooFewMatches:
            ++statistics.too_few_matches;
            break;
        case Outcome::kDegenerate:
            ++statistics.degenerate;
            break;
        case Outcome::kFailed:
            break;
    }
}

/// Candidates that are tried side by side next: as many as it takes for what is missing, going by
/// what came of those before, but few enough to stop in time and enough for several threads.
std::size_t size_of_round(std::size_t tried, std::size_t verified, std::size_t enough) {
    if (tried == 0) return enough;
    const std::size_t missing = enough - verified;
    const std::size_t expected = (missing * tried + verified) / std::max<std::size_t>(1, verified);
    return std::clamp(expected, std::max<std::size_t>(1, enough / 6),
                      std::max<std::size_t>(1, enough / 2));
}

}  // namespace

FeatureLoader loader_of(std::vector<ImageFeatures> images) {
    auto shared = std::make_shared<const std::vector<ImageFeatures>>(std::move(images));
    return [shared](ImageId id) -> Result<ImageFeatures> {
        const auto found = std::ranges::find(*shared, id, &ImageFeatures::id);
        if (found == shared->end()) {
            return Error{ErrorCode::kNotFound,
                         "no features of image " + std::to_string(index_of(id))};
        }
        return *found;
    };
}

Result<void> validate(const VerificationOptions& options) {
    if (const Result<void> valid = validate(options.match); !valid.ok()) return valid.error();
    if (const Result<void> valid = validate(options.cells); !valid.ok()) return valid.error();
    return validate(options.verify);
}

Result<TwoViewGeometry> verify_images(const ImageFeatures& a, const ImageFeatures& b,
                                      std::span<const FeatureMatch> matches,
                                      const VerifyOptions& options, std::uint64_t seed) {
    const bool straight = comes_first(a, b);
    const ImageFeatures& first = straight ? a : b;
    const ImageFeatures& second = straight ? b : a;
    std::vector<FeatureMatch> directed(matches.begin(), matches.end());
    if (!straight) {
        for (FeatureMatch& match : directed) std::swap(match.first, match.second);
    }
    const std::uint64_t pair_seed = mix(mix(mix(seed) ^ first.content_hash) ^ second.content_hash);
    Result<TwoViewGeometry> geometry =
        verify_pair({*first.keypoints, *second.keypoints, first.camera, second.camera, directed},
                    options, pair_seed);
    if (!geometry.ok() || straight) return geometry;
    return invert(*geometry);
}

Result<VerificationOutput> run_verification(const VerificationInput& input,
                                            const VerificationOptions& options) {
    if (const Result<void> valid = validate(options); !valid.ok()) return valid.error();
    if (const Result<void> valid = check(input.image); !valid.ok()) return valid.error();
    const std::vector<ImageId> candidates = without_repetitions(input.candidates);
    if (std::ranges::find(candidates, input.image.id) != candidates.end()) {
        return Error{ErrorCode::kInvalidArgument,
                     "image " + std::to_string(index_of(input.image.id)) + " is its own candidate"};
    }
    if (candidates.empty()) return VerificationOutput{};

    const PreparedDescriptors prepared = prepare(*input.image.descriptors, options.cells);
    const std::size_t enough =
        input.ranked && options.enough_pairs > 0 ? options.enough_pairs : candidates.size();
    VerificationOutput output;
    const std::size_t& verified = output.statistics.verified;
    for (std::size_t tried = 0; tried < candidates.size() && verified < enough;
         tried = output.statistics.tried) {
        const std::size_t round = size_of_round(tried, verified, enough);
        std::vector<Attempt> attempts(std::min(round, candidates.size() - tried));
        in_parallel(attempts.size(), [&](std::size_t i) {
            attempts[i] = attempt_pair_catching(input, prepared, candidates[tried + i], options);
        });
        for (Attempt& attempt : attempts) {
            if (attempt.outcome == Outcome::kFailed) return std::move(attempt.error);
            count(attempt, output.statistics);
            if (attempt.pair) output.pairs.push_back(std::move(attempt.pair));
        }
    }
    std::ranges::sort(output.pairs, {}, [](const VerifiedPairPtr& pair) { return pair->pair; });
    return output;
}

}  // namespace psfm
