// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <map>
#include <optional>
#include <span>
#include <vector>

#include "graph/ids.h"

namespace psfm {

/// Which cluster places each image: the one that it is a member of, or a host that tries it as a
/// guest, since its own is below mu_min (host_cluster) or could not place it: then it is adopted.
/// A value; knows nothing of models. Images are known from belongs_to() on, which all else
/// requires.
class ImageHosts {
  public:
    /// Makes an image a member of a cluster. Its host stays.
    void belongs_to(ImageId image, ClusterId own);
    /// Makes it a guest; nothing: of no cluster any more. Ends an adoption.
    void set_host(ImageId image, std::optional<ClusterId> host);
    /// Makes it a guest of a cluster that may keep it (ClusterTable::stays_adopted).
    void adopt(ImageId image, ClusterId host);

    std::size_t image_count() const { return own_.size(); }
    ClusterId own(ImageId image) const;
    std::optional<ClusterId> host(ImageId image) const;  ///< of a guest
    /// Its host where it is a guest, else its own.
    ClusterId placing(ImageId image) const { return host(image).value_or(own(image)); }
    bool is_adopted(ImageId image) const { return home_of_adopted_.contains(image); }
    /// Whether an adopted image is still a member of the cluster that it came from.
    bool is_at_home(ImageId image) const;
    /// Ascending; also those that a cluster had when it was removed, until they get another host.
    std::span<const ImageId> guests_of(ClusterId cluster) const;
    /// The adopted ones among them, ascending.
    std::vector<ImageId> adopted_by(ClusterId cluster) const;

  private:
    void move_to(ImageId image, std::optional<ClusterId> host);

    std::vector<ClusterId> own_;                        // by image
    std::vector<std::optional<ClusterId>> host_;        // by image; those of guests
    std::map<ClusterId, std::vector<ImageId>> guests_;  // by host; none is empty
    std::map<ImageId, ClusterId> home_of_adopted_;      // their own cluster when they were adopted
};

}  // namespace psfm
