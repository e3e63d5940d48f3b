// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>

#include "graph/result.h"
#include "storage/exchange/models/dataset_record.h"
#include "storage/exchange/models/previous_export.h"
#include "tools/commands/exchange/export_dataset.h"

namespace psfm {

/// What a data set's record keeps of the options. @param arguments  paths as given
DatasetRequest request_of(const DatasetArguments& arguments);

/// The options with those of an earlier export into the folder where nothing else is asked for now,
/// if they say so (as_before).
/// @param previous  of that folder
/// @errors kNotFound: the masks' folder of then is gone
Result<DatasetArguments> with_request_of_before(const DatasetArguments& arguments,
                                                const std::filesystem::path& output,
                                                const PreviousExport& previous);

}  // namespace psfm
