// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "tools/commands/console/evaluation_report.h"

#include <algorithm>
#include <iomanip>
#include <nlohmann/json.hpp>
#include <sstream>

#include "storage/exchange/files/json_text.h"

namespace psfm {
namespace {

using Json = nlohmann::ordered_json;

Json model_json(const EvaluatedModel& model) {
    Json json{{"model", model.name}, {"registered", model.registered}, {"points", model.points}};
    if (model.evaluation) {
        const ModelEvaluation& evaluation = *model.evaluation;
        json["ate_mean"] = evaluation.position_mean;
        json["ate_median"] = evaluation.position_median;
        json["ate_rmse"] = evaluation.position_rms;
        json["ate_rel"] = evaluation.position_relative;
        json["rot_median_deg"] = evaluation.rotation_median_deg;
        json["rot_max_deg"] = evaluation.rotation_max_deg;
        json["outliers"] = evaluation.outliers;
        return json;
    }
    for (const char* key : {"ate_mean", "ate_median", "ate_rmse", "ate_rel", "rot_median_deg",
                            "rot_max_deg", "outliers"}) {
        json[key] = nullptr;
    }
    json["error"] = model.evaluation.error().message;
    return json;
}

/// "5" for 5.0, as the keys of "auc" are written.
std::string limit_name(double limit_deg) {
    std::ostringstream name;
    name << limit_deg;
    return name.str();
}

void add_row(std::ostream& out, std::size_t name_width, const EvaluatedModel& model) {
    out << std::left << std::setw(static_cast<int>(name_width)) << model.name << std::right
        << std::setw(11) << model.registered << std::setw(9) << model.points;
    if (!model.evaluation) {
        out << "  not judged: " << model.evaluation.error().message << '\n';
        return;
    }
    const ModelEvaluation& evaluation = *model.evaluation;
    out << std::setprecision(4) << std::setw(11) << evaluation.position_mean << std::setw(11)
        << evaluation.position_median << std::setw(11) << evaluation.position_rms << std::setw(10)
        << 100.0 * evaluation.position_relative << " %" << std::setw(11)
        << evaluation.rotation_median_deg << std::setw(10) << evaluation.rotation_max_deg
        << std::setw(10) << evaluation.outliers << '\n';
    if (!evaluation.consensus) {
        out << "  no three cameras agree with the reference: aligned by all of them\n";
    }
    if (evaluation.images.size() < evaluation.registered) {
        out << "  " << evaluation.registered - evaluation.images.size()
            << " of its images are not in the reference\n";
    }
}

void add_header(std::ostream& out, std::size_t name_width, const std::string& title) {
    out << std::left << std::setw(static_cast<int>(name_width)) << title << std::right
        << std::setw(11) << "registered" << std::setw(9) << "points" << std::setw(11) << "mean"
        << std::setw(11) << "median" << std::setw(11) << "rms" << std::setw(12) << "rms/size"
        << std::setw(11) << "rot med" << std::setw(10) << "rot max" << std::setw(10) << "outliers"
        << '\n';
}

void add_versions(std::ostream& out, const std::vector<EvaluatedVersion>& versions) {
    out << "\nversions (outliers: over effective clusters of at least five cameras)\n"
        << " image  placed  clusters  outliers  largest: images  outliers       mean\n";
    for (const EvaluatedVersion& version : versions) {
        out << std::setw(6) << version.image << std::setw(8) << version.placed << std::setw(10)
            << version.effective_clusters << std::setw(10) << version.outliers;
        if (version.largest) {
            out << std::setw(17) << version.largest->registered;
            if (version.largest->evaluation) {
                out << std::setw(10) << version.largest->evaluation->outliers << std::setw(11)
                    << std::setprecision(4) << version.largest->evaluation->position_mean;
            }
        }
        out << '\n';
    }
}

}  // namespace

std::string to_json(const EvaluationReport& report) {
    Json json{{"reference", report.reference}, {"models", Json::array()}};
    for (const EvaluatedModel& model : report.models) json["models"].push_back(model_json(model));
    json["auc"] = Json::object();
    for (std::size_t i = 0; i < report.auc.size(); ++i) {
        json["auc"][limit_name(report.auc_limits_deg[i])] = report.auc[i];
    }
    if (report.versions) {
        json["versions"] = Json::array();
        for (const EvaluatedVersion& version : *report.versions) {
            json["versions"].push_back(
                {{"image", version.image},
                 {"placed", version.placed},
                 {"effective_clusters", version.effective_clusters},
                 {"outliers", version.outliers},
                 {"largest", version.largest ? model_json(*version.largest) : Json(nullptr)}});
        }
    }
    // File names need not be UTF-8: what is not becomes U+FFFD.
    return json_text(json, 2) + '\n';
}

std::string to_table(const EvaluationReport& report) {
    std::ostringstream out;
    out << "reference " << report.reference << ": " << report.reference_cameras << " cameras";
    for (const EvaluatedModel& model : report.models) {
        if (!model.evaluation) continue;
        out << "; an outlier is off by more than " << model.evaluation->outlier_threshold;
        break;
    }
    out << "\nPositions in the reference's units, rotations in degrees.\n\n";
    std::size_t name_width = 5;
    for (const EvaluatedModel& model : report.models)
        name_width = std::max(name_width, model.name.size());
    add_header(out, name_width, "model");
    for (const EvaluatedModel& model : report.models) add_row(out, name_width, model);
    out << "\nAUC of relative poses" << (report.models.size() > 1 ? " (first model)" : "") << ':';
    for (std::size_t i = 0; i < report.auc.size(); ++i) {
        out << "  " << report.auc_limits_deg[i] << " deg " << std::fixed << std::setprecision(2)
            << 100.0 * report.auc[i] << " %" << std::defaultfloat;
    }
    out << '\n';
    if (report.versions) add_versions(out, *report.versions);
    return out.str();
}

}  // namespace psfm
