// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
//
// A damaged session is run again into a new folder beside it: images and pairs are taken over where
// their records are intact, and everything else follows from them as it did the first time. Then
// the new database takes the damaged one's place in the session's folder, in which all else stays.
#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <filesystem>
#include <iostream>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "graph/wording.h"
#include "scheduler/front_end/salvage.h"
#include "scheduler/front_end/salvage_photographs.h"
#include "storage/database/file_lock.h"
#include "storage/database/rebuild_database.h"
#include "storage/database/replace_database.h"
#include "storage/database/session_folder.h"
#include "storage/database/system_error.h"
#include "tools/commands/commands.h"
#include "tools/commands/console/exit_codes.h"
#include "tools/commands/console/report_error.h"
#include "tools/commands/session/session_runner.h"

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
        // Behind a link it may be on another file system than the link, which no rename leads to.
        std::error_code unknown;
        if (fs::is_symlink(session, unknown)) {
            const fs::path target = fs::canonical(session, unknown);
            if (!unknown) session = target;
        }
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
    fs::path damaged;   ///< the damaged database in the end
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

/// What examine() has made is gone again.
void leave_alone(const Folders& folders, Patient& patient) {
    patient.reader.reset();
    std::error_code stays;
    fs::remove_all(folders.rebuilt, stays);
}

/// The last steps of a repair. Writers are kept out. @return the exit code; failures were reported
int replace_and_tell(const Folders& folders) {
    const auto done = replace_database(folders.session, folders.repaired, folders.damaged);
    if (!done.ok()) return report_error(done.error());
    std::cout << "the session is whole again; its damaged database lies in "
              << folders.damaged.string() << " and can be deleted\n";
    return 0;
}

/// The same of a repair that was stopped in the middle of them.
int finish_earlier_repair(const Folders& folders) {
    const auto lock = SessionLock::acquire(folders.session);
    if (!lock.ok()) return report_error(lock.error());
    return replace_and_tell(folders);
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
    request.photos = photographs_to_salvage(*patient.reader, *intact, request.config, request.input,
                                            request.session);
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
        if (const auto done = keep_sources(*intact, salvage, **store); !done.ok())
            return report_error(done.error());
        const auto told = tell_outcome(salvage, *intact, **store);
        if (!told.ok()) return report_error(told.error());
        lost = *told;
    }
    leave_alone(folders, patient);
    if (const int code = replace_and_tell(folders); code != 0) return code;
    if (lost == 0) return 0;
    std::cerr << "psfm: " << counted(lost, "image") << " could not be recomputed; put "
              << (lost == 1 ? "its file" : "their files") << " back and 'psfm run' adds "
              << (lost == 1 ? "it" : "them") << '\n';
    return 1;
}

/// What is to be done about the folder of an earlier repair. It may hold all of a session's folder,
/// with what nothing can recompute.
std::string advice_on_damaged(const Folders& folders) {
    const std::vector<std::string> kept = entries_of_others(folders.damaged);
    if (!fs::exists(folders.session)) {
        return quoted(folders.session) + " is not there, but " + quoted(folders.damaged) +
               " is, from an earlier repair; name that one " + quoted(folders.session) +
               " and repair it";
    }
    if (kept.empty())
        return quoted(folders.damaged) + " is there from an earlier repair; move or delete it";
    return quoted(folders.damaged) +
           " is there from an earlier repair, with files that belong to the session: " +
           some_of(kept) + "; move these to " + quoted(folders.session) + ", then delete it";
}

int refuse_second_repair(const Folders& folders) {
    return report_error({ErrorCode::kInvalidArgument, advice_on_damaged(folders)});
}

/// Nothing is damaged; what earlier repairs have left is told.
int tell_sound(const Folders& folders) {
    std::cout << "every record is intact; there is nothing to repair\n";
    if (!entries_of_others(folders.damaged).empty())
        std::cerr << "psfm: " << advice_on_damaged(folders) << '\n';
    if (fs::exists(folders.repaired)) {
        std::cerr << "psfm: " << quoted(folders.repaired)
                  << " is left of a repair that was stopped, and can be deleted\n";
    }
    return 0;
}

int repair(const RepairArguments& arguments) {
    const Folders folders{arguments.session};
    if (is_replacing(folders.repaired)) {
        if (const int code = finish_earlier_repair(folders); code != 0) return code;
    }
    const bool is_second = fs::exists(folders.damaged);
    if (is_second && !fs::exists(folders.session)) return refuse_second_repair(folders);
    auto patient = examine(folders);
    if (!patient.ok()) return report_error(patient.error());
    if (patient->damaged_records == 0) return tell_sound(folders);
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
        "photographs otherwise, and clusters and models from them. The damaged database is kept "
        "as\n"
        "DIR.damaged; all else in DIR stays as it is. Exit code 1 when an image is lost: its "
        "records\nare damaged and its file is gone.\nExample: psfm repair --session castle");
    command->callback([arguments, &exit_code] { exit_code = repair(*arguments); });
}

}  // namespace psfm
