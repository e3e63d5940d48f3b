// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
//
// A damaged session is run again into a new folder beside it: images and pairs are taken over where
// their records are intact, and everything else follows from them as it did the first time. Then
// the two folders change their names.
#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <filesystem>
#include <iostream>
#include <map>
#include <memory>
#include <optional>
#include <set>

#include "graph/wording.h"
#include "scheduler/front_end/salvage.h"
#include "storage/database/file_lock.h"
#include "storage/database/rebuild_database.h"
#include "storage/database/session_folder.h"
#include "storage/database/system_error.h"
#include "tools/commands/commands.h"
#include "tools/commands/console/exit_codes.h"
#include "tools/commands/console/report_error.h"
#include "tools/commands/session_runner.h"

namespace psfm {
namespace {

namespace fs = std::filesystem;

struct RepairArguments {
    std::string session;
    std::string log;
    int threads = 0;
};

/// Folders beside the session.
struct Folders {
    explicit Folders(const fs::path& the_session)
        : session(fs::absolute(the_session).lexically_normal()) {
        if (session.filename().empty()) session = session.parent_path();
        repaired = session;
        repaired += ".repairing";
        rebuilt = session;
        rebuilt += ".rebuilt";
        damaged = session;
        damaged += ".damaged";
    }
    fs::path session;
    fs::path repaired;  ///< the new session, until it is whole
    fs::path rebuilt;   ///< a copy that opens, of a database that does not
    fs::path damaged;   ///< the old session in the end
};

/// The damaged session, as far as it can be read, and its writers kept out.
struct Patient {
    std::unique_ptr<SessionReader> reader;
    std::optional<SessionLock> lock;
    std::size_t damaged_records = 0;
};

Result<Patient> examine(const Folders& folders) {
    Patient patient;
    auto reader = open_session_reader(folders.session, {});
    const bool opens = reader.ok();
    // Expected: damaged, which is what is to be repaired
    if (!opens && reader.error().code != ErrorCode::kDamaged) return reader.error();
    auto lock = SessionLock::acquire(folders.session);
    if (!lock.ok()) return lock.error();
    patient.lock = *std::move(lock);
    if (!opens) {
        if (const auto done = rebuild_database(folders.session, folders.rebuilt); !done.ok())
            return done.error();
        reader = open_session_reader(folders.rebuilt, {});
        if (!reader.ok()) return reader.error();
        patient.damaged_records = 1;  // the index
    }
    patient.reader = *std::move(reader);
    const auto report = patient.reader->check({});
    if (!report.ok()) return report.error();
    for (const DamagedRecord& record : report->damaged)
        std::cout << "DAMAGED " << record.kind << ' ' << record.key << ": " << record.problem
                  << '\n';
    patient.damaged_records += report->damaged.size();
    return patient;
}

/// The photographs in the order in which they were accepted. Where the record of one is damaged its
/// name is lost, too: the next one in order of arrival that the session does not know stands there.
Result<std::vector<PhotoFile>> photos_to_accept(const SessionReader& damaged,
                                                const IntactImages& intact,
                                                const RunRequest& request) {
    std::set<std::string> known;
    for (const Image& image : intact.images) known.insert(image.name);
    // Expected: where these are damaged their photographs are looked at again
    if (const auto rejected = damaged.rejected(); rejected.ok()) {
        for (const RejectedPhoto& photo : *rejected) known.insert(photo.name);
    }
    const bool is_database = !request.config.colmap_database.empty();
    const auto photo_of = [&](const std::string& name) {
        return PhotoFile{is_database ? request.input : request.input / name, name};
    };
    std::vector<PhotoFile> arriving;
    arriving.reserve(request.config.order.size());
    for (const std::string& name : request.config.order) arriving.push_back(photo_of(name));
    if (arriving.empty()) {
        // Expected: a folder that is gone has no photographs; what was extracted is taken over
        if (auto listed = photos_by_name(request); listed.ok())
            arriving = std::move(listed->photos);
    }
    std::erase_if(arriving, [&](const PhotoFile& photo) { return known.contains(photo.name); });

    std::vector<PhotoFile> photos;
    auto image = intact.images.begin();
    auto unknown = arriving.begin();
    for (std::uint32_t id = 0; id < intact.count; ++id) {
        if (image != intact.images.end() && index_of(image->id) == id) {
            const bool is_removed = intact.removed.contains(image->id);
            if (!is_removed) photos.push_back(photo_of(image->name));
            ++image;
        } else if (unknown != arriving.end()) {
            photos.push_back(*unknown++);
        }
    }
    return photos;
}

/// What was taken out of the damaged session stays out of the new one.
Result<void> keep_out(const SessionReader& damaged, const IntactImages& intact,
                      SessionStore& repaired) {
    if (intact.removed.empty()) return {};
    std::set<std::string> names;
    for (const Image& image : intact.images) {
        if (intact.removed.contains(image.id)) names.insert(image.name);
    }
    const auto rejected = damaged.rejected();
    if (!rejected.ok()) return {};  // Expected: damaged; they may come in again
    for (const RejectedPhoto& photo : *rejected) {
        if (!names.contains(photo.name)) continue;
        if (auto stored = repaired.commit_rejected(photo); !stored.ok()) return stored.error();
    }
    return {};
}

/// Says what was taken over, and names what could not be recomputed. @return images lost
/// @errors those of the store
Result<std::size_t> tell_outcome(const Salvage& salvage, const IntactImages& intact,
                                 const SessionReader& repaired) {
    std::cout << "taken over: " << counted(salvage.images_taken_over, "image") << ", "
              << counted(salvage.pair_lists_taken_over, "list")
              << " of pairs; recomputed: " << counted(salvage.images_extracted, "image") << ", "
              << counted(salvage.pair_lists_verified, "list")
              << " of pairs, all clusters and models\n";
    const auto images = repaired.images();
    if (!images.ok()) return images.error();
    std::set<std::string> there;
    for (const Image& image : *images) there.insert(image.name);
    const auto rejected = repaired.rejected();
    if (!rejected.ok()) return rejected.error();
    std::map<std::string, std::string> reasons;
    for (const RejectedPhoto& photo : *rejected) reasons[photo.name] = photo.reason;
    for (const Image& image : intact.images) {
        if (!there.contains(image.name) && !intact.removed.contains(image.id))
            std::cout << "LOST " << image.name << ": " << reasons[image.name] << '\n';
    }
    const std::size_t wanted = intact.count - intact.removed.size();
    return wanted - std::min(wanted, there.size());
}

Result<void> change_names(const Folders& folders) {
    std::error_code error;
    fs::rename(folders.session, folders.damaged, error);
    if (!error) fs::rename(folders.repaired, folders.session, error);
    if (error) {
        return system_error("cannot name " + quoted(folders.repaired) + " " +
                                quoted(folders.session) + " (do it by hand)",
                            error.value());
    }
    fs::remove_all(folders.rebuilt, error);
    return {};
}

/// What examine() has made is gone again.
void leave_alone(const Folders& folders, Patient& patient) {
    patient.reader.reset();
    std::error_code stays;
    fs::remove_all(folders.rebuilt, stays);
}

int run_again(const Folders& folders, const RepairArguments& arguments, Patient& patient) {
    const auto settings = patient.reader->settings();
    if (!settings.ok()) {
        std::cerr << "psfm: the settings of " << quoted(folders.session)
                  << " are lost and cannot be recomputed (" << settings.error().message
                  << "); run its photographs into a new session\n";
        leave_alone(folders, patient);
        return kStoreDamaged;
    }
    auto config = decode_config(settings->settings_json);
    if (!config.ok()) return report_error(config.error());
    const auto intact = patient.reader->intact_images();
    if (!intact.ok()) return report_error(intact.error());

    RunRequest request;
    request.session = folders.session;
    request.input = input_of(*settings, *config);
    request.config = *std::move(config);
    request.execution = execution_of(arguments.threads, {});
    request.log_file = arguments.log;
    request.go_on_command = command_line("repair", request.session);
    auto photos = photos_to_accept(*patient.reader, *intact, request);
    if (!photos.ok()) return report_error(photos.error());
    request.photos = *std::move(photos);
    Salvage salvage;
    salvage.session = patient.reader.get();
    salvage.images = intact->images;
    std::erase_if(salvage.images,
                  [&](const Image& image) { return intact->removed.contains(image.id); });
    request.salvage = &salvage;

    std::size_t lost = 0;
    {
        auto store = SessionStore::open(folders.repaired, {});
        if (!store.ok()) return report_error(store.error());
        if (const auto done = (*store)->put_settings(*settings); !done.ok())
            return report_error(done.error());
        if (const auto done = keep_out(*patient.reader, *intact, **store); !done.ok())
            return report_error(done.error());
        if (const int code = run_and_report(**store, request); code != 0) return code;
        const auto told = tell_outcome(salvage, *intact, **store);
        if (!told.ok()) return report_error(told.error());
        lost = *told;
    }
    patient.reader.reset();
    if (const auto done = change_names(folders); !done.ok()) return report_error(done.error());
    std::cout << "the session is whole again; what was damaged lies in " << folders.damaged.string()
              << " and can be deleted\n";
    if (lost == 0) return 0;
    std::cerr << "psfm: " << counted(lost, "image") << " could not be recomputed; put "
              << (lost == 1 ? "its file" : "their files") << " back and 'psfm run' adds "
              << (lost == 1 ? "it" : "them") << '\n';
    return 1;
}

int refuse_second_repair(const Folders& folders) {
    return report_error(
        {ErrorCode::kInvalidArgument,
         quoted(folders.damaged) + " is there from an earlier repair; move or delete it"});
}

int repair(const RepairArguments& arguments) {
    const Folders folders{arguments.session};
    const bool is_second = fs::exists(folders.damaged);
    if (is_second && !fs::exists(folders.session)) return refuse_second_repair(folders);
    auto patient = examine(folders);
    if (!patient.ok()) return report_error(patient.error());
    if (patient->damaged_records == 0) {
        std::cout << "every record is intact; there is nothing to repair\n";
        return 0;
    }
    if (is_second) {
        leave_alone(folders, *patient);
        return refuse_second_repair(folders);
    }
    return run_again(folders, arguments, *patient);
}

}  // namespace

void add_repair_command(CLI::App& app, int& exit_code) {
    CLI::App* command =
        app.add_subcommand("repair", "Recompute what is damaged in a session from what is intact");
    auto arguments = std::make_shared<RepairArguments>();
    command->add_option("--session", arguments->session, "Session folder")->required();
    command->add_option("--threads", arguments->threads, "Threads to use; 0: one a core")
        ->check(CLI::Range(0, 1024));
    command->add_option("--log", arguments->log, "Append a log of JSON lines to this file");
    command->footer(
        "Images and verified pairs are kept where their records are intact; features come from "
        "the\n"
        "photographs otherwise, and clusters and models from them. The damaged session is kept as\n"
        "DIR.damaged. Exit code 1 when an image is lost: its records are damaged and its file is "
        "gone.\nExample: psfm repair --session castle");
    command->callback([arguments, &exit_code] { exit_code = repair(*arguments); });
}

}  // namespace psfm
