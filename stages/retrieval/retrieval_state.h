// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <functional>
#include <memory>

#include "graph/ids.h"
#include "graph/image.h"
#include "graph/result.h"
#include "stages/retrieval/inverted_file.h"
#include "stages/retrieval/vocabulary.h"

namespace psfm {

/// Descriptors of an image accepted before; called one image at a time, from the thread that
/// retrieves.
using DescriptorSource = std::function<Result<std::shared_ptr<const Descriptors>>(ImageId)>;

/// Reads a vocabulary when it is wanted for the first time.
using VocabularySource = std::function<Result<std::shared_ptr<const Vocabulary>>()>;

/// What retrieval remembers between images. Owned by one serial node; not thread-safe. It is a
/// function of the images' descriptors in their order, the options and the given vocabulary, so
/// that it need not be stored: rebuild_retrieval() makes it anew.
struct RetrievalState {
    /// Vocabulary of the user's (--vocabulary), or the independent one once it is in use; nothing:
    /// one is trained from the session's own images.
    std::shared_ptr<const Vocabulary> given;
    /// Of many words, trained from other photographs: takes the place of the session's own when
    /// there are too many images to train from (RetrievalOptions::max_training_images). Empty:
    /// there is none.
    VocabularySource independent;
    /// In use: the given one, or the last trained; nothing before the first training.
    std::shared_ptr<const Vocabulary> vocabulary;
    InvertedFile index;             ///< holds all images whenever there is a vocabulary
    std::uint32_t image_count = 0;  ///< images 0 … image_count - 1 have been taken in

    /// Of all but where another vocabulary would come from.
    bool operator==(const RetrievalState& other) const;
};

/// A session without images. @param given, independent  see RetrievalState; may be empty
RetrievalState make_retrieval_state(std::shared_ptr<const Vocabulary> given,
                                    VocabularySource independent = {});

}  // namespace psfm
