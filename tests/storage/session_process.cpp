// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
// Another process for the tests of the session store.
//   session_process hold FOLDER         opens for writing, prints "ready", waits for its input
//   session_process read FOLDER         reads as someone who may not write, prints how many images,
//                                       or why not
//   session_process write FOLDER COUNT  opens, commits images up to COUNT, printing each one's
//                                       number when all its commits have returned
//   session_process leave FOLDER COUNT  the same, then dies without closing the store
//   session_process grow FOLDER COUNT   a new session of COUNT images, solutions stored as changes
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <string>

#include "tests/storage/growing_session.h"
#include "tests/storage/test_session.h"

namespace {

int fail(const std::string& message) {
    std::fprintf(stderr, "%s\n", message.c_str());
    return EXIT_FAILURE;
}

int read_as_nobody(const std::string& folder) {
    constexpr uid_t kNobody = 65534;
    if (geteuid() == 0 && setuid(kNobody) != 0) return fail("cannot become nobody");
    const auto reader = psfm::open_session_reader(folder, {});
    if (!reader) {
        std::printf("%s\n", reader.error().message.c_str());
        return EXIT_FAILURE;
    }
    const auto images = (*reader)->images();
    if (!images) return fail(images.error().message);
    std::printf("%zu\n", images->size());
    return EXIT_SUCCESS;
}

}  // namespace

int main(int argc, char** argv) {
    if (argc < 3) return fail("usage: session_process hold|read|write|leave|grow FOLDER [COUNT]");
    const std::string command = argv[1];
    if (command == "read") return read_as_nobody(argv[2]);
    auto store = psfm::SessionStore::open(argv[2], {});
    if (!store) return fail(store.error().message);
    if (command == "hold") {
        std::printf("ready\n");
        std::fflush(stdout);
        while (std::getchar() != EOF) {
        }
        return EXIT_SUCCESS;
    }
    const auto images = (*store)->images();
    if (!images || argc < 4) return fail("cannot read images, or no COUNT");
    const auto count = static_cast<std::uint32_t>(std::stoul(argv[3]));
    if (command == "grow") {
        psfm::testing::GrowingSession session(psfm::testing::kGrownSeed);
        for (std::uint32_t image = 0; image < count; ++image) {
            if (!session.add_all(**store)) return fail("commit failed");
        }
        return EXIT_SUCCESS;
    }
    for (auto image = static_cast<std::uint32_t>(images->size()); image < count; ++image) {
        if (!psfm::testing::commit_all(**store, image)) return fail("commit failed");
        std::printf("%u\n", image);
        std::fflush(stdout);
    }
    if (command == "leave") _exit(EXIT_SUCCESS);
    return EXIT_SUCCESS;
}
