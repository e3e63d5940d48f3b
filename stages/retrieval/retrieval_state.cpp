// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/retrieval/retrieval_state.h"

#include <utility>

namespace psfm {
namespace {

bool equal(const std::shared_ptr<const Vocabulary>& a, const std::shared_ptr<const Vocabulary>& b) {
    return a && b ? *a == *b : !a && !b;
}

}  // namespace

bool RetrievalState::operator==(const RetrievalState& other) const {
    return equal(given, other.given) && equal(vocabulary, other.vocabulary) &&
           index == other.index && image_count == other.image_count;
}

RetrievalState make_retrieval_state(std::shared_ptr<const Vocabulary> given,
                                    VocabularySource independent) {
    RetrievalState state;
    if (!given) state.independent = std::move(independent);
    if (given) state.index = InvertedFile(given->word_count());
    state.vocabulary = given;
    state.given = std::move(given);
    return state;
}

}  // namespace psfm
