// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>
#include <unistd.h>

#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <iostream>
#include <memory>
#include <optional>

#include "stages/features/photographs/photo_listing.h"
#include "stages/features/run_features.h"
#include "stages/retrieval/retrieval_options.h"
#include "stages/retrieval/session_vocabulary.h"
#include "stages/retrieval/train_vocabulary.h"
#include "stages/retrieval/vocabulary_file.h"
#include "tools/commands/commands.h"
#include "tools/commands/console/progress.h"
#include "tools/commands/console/report_error.h"
#include "tools/commands/console/thread_budget.h"
#include "tools/commands/session/installed_vocabulary.h"

namespace psfm {
namespace {

/// Guard: keeps k-means from what it cannot do: of fewer training descriptors a word, words
/// describe one descriptor, not a kind of them.
constexpr std::size_t kDescriptorsPerWord = 8;
/// Guard: photographs between two lines of progress; their features are in memory together.
constexpr std::size_t kBatch = 32;

struct TrainArguments {
    std::string photos;
    std::string output;
    std::size_t words = 1000000;
    std::size_t descriptors = 8000000;
    int threads = 0;
};

/// Rewrites one line on a terminal; silent elsewhere.
class TrainProgress {
  public:
    explicit TrainProgress(std::size_t photos) : photos_(photos) {}
    ~TrainProgress() { clear(); }
    TrainProgress(const TrainProgress&) = delete;
    TrainProgress& operator=(const TrainProgress&) = delete;

    void show_photos(std::size_t done) {
        const double seconds =
            std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
        const double rate = static_cast<double>(done) / std::max(seconds, 1e-3);
        char text[120];
        std::snprintf(text, sizeof(text), "%zu/%zu photographs, %.2f a second, %s left", done,
                      photos_, rate,
                      format_duration(static_cast<double>(photos_ - done) / rate).c_str());
        show(text);
    }
    void show(const std::string& text) {
        if (!terminal_) return;
        std::cerr << "\r\x1b[K" << text << std::flush;
        open_ = true;
    }
    void clear() {
        if (open_) std::cerr << "\r\x1b[K" << std::flush;
        open_ = false;
    }

  private:
    std::size_t photos_;
    bool terminal_ = isatty(STDERR_FILENO) == 1;
    bool open_ = false;
    std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

/// Where the vocabulary goes: with the folder made, where it is the user's. @errors kIo,
/// kInvalidArgument
Result<std::string> output_of(const TrainArguments& arguments) {
    if (!arguments.output.empty()) return arguments.output;
    const std::filesystem::path file = vocabulary_of_user();
    if (file.empty()) {
        return Error{ErrorCode::kInvalidArgument,
                     "no home folder to put the vocabulary into; name a file with --output"};
    }
    std::error_code failed;
    if (file.has_parent_path()) std::filesystem::create_directories(file.parent_path(), failed);
    if (failed) {
        return Error{ErrorCode::kIo, file.parent_path().string() + ": " + failed.message() +
                                         "; name a file with --output"};
    }
    return file.string();
}

/// What would make the last step fail is better said before the first.
std::optional<Error> output_problem(const std::filesystem::path& file) {
    std::error_code ignored;
    const std::filesystem::path folder = file.has_parent_path() ? file.parent_path() : ".";
    if (std::filesystem::is_directory(file, ignored)) {
        return Error{ErrorCode::kInvalidArgument,
                     file.string() + ": is a folder; --output names a file"};
    }
    if (!std::filesystem::is_directory(folder, ignored)) {
        return Error{ErrorCode::kNotFound,
                     folder.string() + ": no such folder; create it, or choose another --output"};
    }
    if (::access(folder.c_str(), W_OK) != 0) {
        return Error{ErrorCode::kInvalidArgument,
                     folder.string() + ": not writable; choose another --output"};
    }
    return std::nullopt;
}

struct Sample {
    Descriptors descriptors;
    std::size_t photos = 0;  ///< that gave some
};

/// Descriptors spread evenly over the photographs, in their order whatever the threads do.
Sample sample_descriptors(const std::vector<PhotoFile>& photos, std::size_t limit,
                          TrainProgress& progress) {
    const std::size_t quota = std::max<std::size_t>(1, limit / photos.size());
    const std::size_t features_per_image = RetrievalOptions{}.features_per_image;
    Sample sample;
    for (std::size_t begin = 0; begin < photos.size(); begin += kBatch) {
        const std::size_t end = std::min(begin + kBatch, photos.size());
        std::vector<std::optional<Result<ExtractedPhoto>>> extracted(end - begin);
        tbb::parallel_for(begin, end, [&](std::size_t i) {
            extracted[i - begin] = run_features(photos[i], FeatureOptions{});
        });
        for (const auto& photo : extracted) {
            if (!*photo) {
                progress.clear();
                std::cerr << "left out " << photo->error().message << '\n';
                continue;
            }
            const Descriptors& descriptors = photo->value().descriptors;
            append_spread(sample.descriptors, descriptors, features_per_image, quota);
            sample.photos += descriptors.rows() > 0 ? 1 : 0;
        }
        progress.show_photos(end);
    }
    return sample;
}

int train_and_write(const TrainArguments& arguments, const std::string& output,
                    const std::vector<PhotoFile>& photos) {
    TrainProgress progress(photos.size());
    const Sample sample = sample_descriptors(photos, arguments.descriptors, progress);
    const std::size_t rows = sample.descriptors.rows();
    if (rows == 0) {
        progress.clear();
        return report_error(
            {ErrorCode::kUnreadable, arguments.photos +
                                         ": no photograph with features; train from photographs of "
                                         "textured scenes"},
            ErrorOrigin::kOtherInput);
    }
    const std::size_t words =
        std::min(arguments.words, std::max<std::size_t>(1, rows / kDescriptorsPerWord));
    progress.show("training " + std::to_string(words) + " words from " + std::to_string(rows) +
                  " descriptors");
    const WordTree tree = train_vocabulary(sample.descriptors, {.words = words});
    progress.clear();
    const auto written = write_vocabulary(tree, output);
    if (!written.ok()) return report_error(written.error(), ErrorOrigin::kOtherInput);
    std::cout << output << ": " << tree.word_count() << " words from " << rows << " descriptors of "
              << sample.photos << " photographs\n"
              << std::flush;
    if (words < arguments.words) {
        std::cerr
            << "fewer words than " << arguments.words << ": a word takes " << kDescriptorsPerWord
            << " training descriptors; more photographs or a larger --descriptors give more\n";
    }
    return 0;
}

int run_train(const TrainArguments& arguments) {
    const auto output = output_of(arguments);
    if (!output.ok()) return report_error(output.error(), ErrorOrigin::kOtherInput);
    if (const auto problem = output_problem(*output))
        return report_error(*problem, ErrorOrigin::kOtherInput);
    const auto listing = list_photos(arguments.photos);
    if (!listing.ok()) return report_error(listing.error(), ErrorOrigin::kOtherInput);
    for (const RejectedPath& rejected : listing->rejected) {
        std::cerr << "left out " << rejected.name << ": " << rejected.reason << '\n';
    }
    if (listing->photos.empty()) {
        return report_error(
            {ErrorCode::kNotFound, arguments.photos + ": holds no photograph that can be read"},
            ErrorOrigin::kOtherInput);
    }
    const ThreadBudget budget(arguments.threads);
    tbb::task_arena arena(arguments.threads > 0 ? arguments.threads : tbb::task_arena::automatic);
    return arena.execute([&] { return train_and_write(arguments, *output, listing->photos); });
}

}  // namespace

void add_vocabulary_command(CLI::App& app, int& exit_code) {
    CLI::App* vocabulary =
        app.add_subcommand("vocabulary", "Make vocabularies of visual words, for large sessions");
    vocabulary->require_subcommand(1);
    vocabulary->footer("psfm vocabulary train --help tells its options.");
    CLI::App* train =
        vocabulary->add_subcommand("train", "Train a vocabulary from a folder of photographs");
    const auto arguments = std::make_shared<TrainArguments>();
    train->add_option("photos", arguments->photos, "Folder of photographs, sub-folders included")
        ->required()
        ->type_name("IMAGES");
    train
        ->add_option(
            "--output", arguments->output,
            "Where the vocabulary goes; an existing file is replaced. Without it: where all "
            "of your sessions find it (~/.local/share/psfm/vocabulary)")
        ->type_name("FILE");
    train
        ->add_option(
            "--words", arguments->words,
            "Words at most; a word takes 8 training descriptors, so few photographs give fewer")
        ->check(CLI::Range(std::size_t{1}, std::size_t{1} << 20U))
        ->capture_default_str()
        ->type_name("N");
    train
        ->add_option("--descriptors", arguments->descriptors,
                     "Descriptors to train from at most, spread evenly over the photographs; about "
                     "300 bytes of "
                     "memory each")
        ->check(CLI::Range(std::size_t{1}, std::size_t{1} << 24U))
        ->capture_default_str()
        ->type_name("N");
    train->add_option("--threads", arguments->threads, "Threads to use; 0: one a core")
        ->check(CLI::Range(0, 1024));
    train->footer(
        "A vocabulary tells which photographs may show the same things, so that not every pair\n"
        "need be matched. Sessions up to 100 images need none, and larger ones train their own.\n"
        "From 6,400 images on that has too few words. Then one of a million words takes over that\n"
        "was trained from other photographs, some thousands of anything with texture. Train it\n"
        "once, without --output; sessions use it by themselves, but for deterministic ones.\n"
        "PSFM_VOCABULARY names another file; set to nothing, none is used. With --vocabulary a\n"
        "session uses a file from its 101st image on. The same photographs give the same file, on\n"
        "any machine and number of threads.\n"
        "\n"
        "Examples:\n"
        "  psfm vocabulary train photos-of-all-kinds\n"
        "  psfm vocabulary train holiday-photos --output words.psfm\n"
        "  psfm run photos --session my-session --vocabulary words.psfm");
    train->callback([arguments, &exit_code] { exit_code = run_train(*arguments); });
}

}  // namespace psfm
