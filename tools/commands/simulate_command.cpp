// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <cstdint>
#include <iostream>
#include <memory>
#include <optional>
#include <string>

#include "tests/synthetic/look_alikes/look_alike_scene.h"
#include "tests/synthetic/look_alikes/write_simulation.h"
#include "tools/commands/commands.h"
#include "tools/commands/console/option_checks.h"
#include "tools/commands/console/report_error.h"

namespace psfm {
namespace {

struct SimulateArguments {
    std::string output;
    std::string scene = "temple";
    std::uint64_t seed = 1;
    std::optional<std::uint32_t> images, symmetry, users;
    std::optional<double> repeated, copied, noise;
    synthetic::SimulationOptions simulation;
};

template <typename T>
void set(T& option, const std::optional<T>& given) {
    option = given.value_or(option);
}

/// A scene by its own options, as they are given, and by those that every scene has.
/// @errors kInvalidArgument: the options
template <typename Options>
Result<synthetic::LookAlikeScene> make_valid(
    Options options, const SimulateArguments& arguments,
    synthetic::LookAlikeScene (*make)(const Options&, std::uint64_t seed)) {
    set(options.images, arguments.images);
    set(options.repeated_part, arguments.repeated);
    set(options.noise_px, arguments.noise);
    if (const auto valid = validate(options); !valid.ok()) return valid.error();
    return make(options, arguments.seed);
}

Result<synthetic::LookAlikeScene> make_scene(const SimulateArguments& arguments) {
    if (arguments.scene == "courtyard") {
        synthetic::CourtyardOptions options;
        set(options.users, arguments.users);
        return make_valid(options, arguments, &synthetic::make_courtyard);
    }
    if (arguments.scene == "streets") {
        synthetic::StreetsOptions options;
        set(options.copied_facades, arguments.copied);
        return make_valid(options, arguments, &synthetic::make_streets);
    }
    synthetic::TempleOptions options;
    set(options.symmetry, arguments.symmetry);
    return make_valid(options, arguments, &synthetic::make_temple);
}

int run_simulate(const SimulateArguments& arguments) {
    // Before the work, which takes a while for large scenes.
    const auto valid = validate(arguments.simulation);
    if (!valid.ok()) throw CLI::ValidationError("simulate", valid.error().message);
    const auto scene = make_scene(arguments);
    if (!scene.ok()) throw CLI::ValidationError("simulate", scene.error().message);
    const auto written = write_simulation(*scene, arguments.simulation, arguments.output);
    if (!written.ok()) return report_error(written.error(), ErrorOrigin::kOtherInput);
    std::cout << arguments.output << ": " << written->images << " images, " << written->features
              << " features, " << written->pairs << " pairs, " << written->folded
              << " of them look-alikes, " << written->matches << " matches\n";
    return 0;
}

}  // namespace

void add_simulate_command(CLI::App& app, int& exit_code) {
    CLI::App* command = app.add_subcommand(
        "simulate", "Make correspondences of a scene whose structure repeats, its truth known");
    const auto arguments = std::make_shared<SimulateArguments>();
    command
        ->add_option("--output", arguments->output,
                     "folder for database.db (COLMAP's format), reference/, order.txt and, of "
                     "streets, districts.txt")
        ->required()
        ->type_name("DIR");
    CLI::Option* scene =
        command
            ->add_option("--scene", arguments->scene,
                         "temple (a ring around equal sides), courtyard (users along a "
                         "quadrangle's facades), streets (a town as large as the number of images)")
            ->check(CLI::IsMember({"temple", "courtyard", "streets"}))
            ->capture_default_str();
    command
        ->add_option("--images", arguments->images,
                     "images [341 for temple, 600 for courtyard, 10000 for streets]")
        ->type_name("N");
    command->add_option("--seed", arguments->seed, "another seed, another scene")
        ->check(whole_number_problem)
        ->type_name("N")
        ->capture_default_str();
    CLI::Option* symmetry =
        command->add_option("--symmetry", arguments->symmetry, "temple: its equal sides [6]")
            ->type_name("K");
    CLI::Option* users =
        command->add_option("--users", arguments->users, "courtyard: how many take images [8]")
            ->type_name("N");
    CLI::Option* copied =
        command
            ->add_option("--copied-facades", arguments->copied,
                         "streets: part of the facades that are copies of others [0.15]")
            ->type_name("PART");
    command
        ->add_option("--repeated", arguments->repeated,
                     "part of what could repeat that does [temple 0.223 of the lasting features, "
                     "courtyard 0.4, streets 0.5 of the points of a copied facade]")
        ->type_name("PART");
    command
        ->add_option("--noise", arguments->noise,
                     "standard deviation of the features' places [0.5 pixels]")
        ->type_name("PX");
    command
        ->add_option("--wrong", arguments->simulation.matches.wrong_part,
                     "part of single wrong matches that verification cannot tell from right ones")
        ->type_name("PART")
        ->capture_default_str();
    command
        ->add_option("--focal-error", arguments->simulation.focal_error,
                     "relative error of the focal lengths in the database")
        ->type_name("PART")
        ->capture_default_str();
    command->footer(
        "database.db holds features without descriptors, and verified pairs, of which look-alikes "
        "have the pose\n"
        "of the folded scene; reference/ the true poses and cameras; order.txt an order of arrival "
        "that makes\n"
        "trouble: each image of the temple followed by its look-alike, several users at once "
        "elsewhere. districts.txt has the images of streets district by district: there what an "
        "image overlaps\n"
        "does not become more while the session grows.\n"
        "Names are in the order in which one person would have taken the images.\n"
        "\n"
        "Examples:\n"
        "  psfm simulate --output temple --symmetry 8 --images 200\n"
        "  psfm import --session S --colmap-database temple/database.db --order temple/order.txt\n"
        "  psfm evaluate --reference temple/reference --session S\n"
        "  psfm simulate --output town --scene streets --images 10000 --copied-facades 0.3");
    command->callback([=, &exit_code] {
        const auto only_for = [&](const CLI::Option* option, const char* wanted) {
            if (option->count() == 0 || arguments->scene == wanted) return;
            throw CLI::ValidationError(option->get_name(),
                                       std::string("is for ") + scene->get_name() + " " + wanted);
        };
        only_for(symmetry, "temple");
        only_for(users, "courtyard");
        only_for(copied, "streets");
        exit_code = run_simulate(*arguments);
    });
}

}  // namespace psfm
