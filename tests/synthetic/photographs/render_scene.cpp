// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause

// psfm-render-scene OUT_DIR [--images N] [--seed S] …: photographs of a place that does not exist,
// with EXIF and true poses, for tools/quickstart and for tests of the whole program.
#include <CLI/CLI.hpp>
#include <iostream>
#include <map>
#include <string>

#include "tests/synthetic/photographs/render.h"

int main(int argc, char** argv) {
    using psfm::synthetic::PhotoScene;
    psfm::synthetic::PhotoSetOptions options;
    std::string folder;
    std::uint64_t seed = 1;
    bool no_exif = false;
    bool gps = false;
    std::uint32_t portrait_every = 0;
    CLI::App app("Renders photographs with EXIF and known poses: OUT_DIR/images and OUT_DIR/gt");
    app.add_option("OUT_DIR", folder, "folder to write to")->required();
    app.add_option("--images", options.images, "number of photographs")->capture_default_str();
    app.add_option("--seed", seed, "another seed, another place")->capture_default_str();
    const std::map<std::string, PhotoScene> scenes{{"courtyard", PhotoScene::kCourtyard},
                                                   {"wall", PhotoScene::kWall}};
    app.add_option("--scene", options.scene, "courtyard (walked around) or wall (walked along)")
        ->transform(CLI::CheckedTransformer(scenes));
    app.add_option("--width", options.width, "[px]")->capture_default_str();
    app.add_option("--height", options.height, "[px]")->capture_default_str();
    app.add_option(
           "--texels-per-metre", options.texels_per_metre,
           "sharpness of the paint: 200 suits 1024 px of width, and takes the time it takes")
        ->capture_default_str();
    app.add_option("--focal-error", options.focal_relative_error,
                   "true over EXIF focal length, minus 1")
        ->capture_default_str();
    app.add_flag("--no-exif", no_exif, "photographs that say nothing of their camera");
    app.add_flag("--gps", gps, "write positions, good to 1.5 m, to EXIF");
    auto* portrait =
        app.add_option("--portrait-every", portrait_every, "every N-th photograph upright")
            ->check(CLI::PositiveNumber);
    try {
        app.parse(argc, argv);
    } catch (const CLI::ParseError& error) {
        const int shown = app.exit(error);
        return shown == 0 ? 0 : 2;
    }
    options.exif = !no_exif;
    if (gps) options.gps.emplace();
    if (*portrait) options.portrait_every = portrait_every;
    const auto plan = psfm::synthetic::render_photographs(options, seed, folder);
    if (!plan.ok()) {
        std::cerr << "psfm-render-scene: " << plan.error().message << '\n';
        return plan.error().code == psfm::ErrorCode::kInvalidArgument ? 2 : 3;
    }
    std::cout << plan->photos.size() << " photographs in " << folder << "/images, their poses in "
              << folder << "/gt\n";
    return 0;
}
