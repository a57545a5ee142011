"""The planted faults: (file, text, what is wrong).

The text must occur in the file exactly once. It has the form BEFORE@@OLD@@NEW@@AFTER; the fault
replaces OLD by NEW. Both are expressions, or both are statements that end with a semicolon. They
must compile as `fault ? (NEW) : (OLD)` or as `if (fault) { NEW } else { OLD }`: a declaration or a
constant expression cannot be replaced.

The faults were chosen by reading the sources, without a look at the tests.
"""

FAULTS = (
    # sim/contact
    (
        "sim/contact/kernel.cc",
        "linear.y() + (@@w.z() * ax - w.x() * az@@w.z() * ax + w.x() * az@@)",
        "sign: velocity of a root in a turn",
    ),
    (
        "sim/contact/kernel.cc",
        "if (any(@@pressed | ~apart | (at(c.mode, i) != 0.0)@@pressed | ~apart@@)) {",
        "missing condition: a group sleeps one step early",
    ),
    (
        "sim/contact/kernel.cc",
        "approach = @@-dot(normal, velocity)@@dot(normal, velocity)@@,",
        "sign: speed of approach in the damped wrench",
    ),
    (
        "sim/contact/return_mapping.h",
        "beyond = asked > most ? @@most@@asked@@ : asked;",
        "missing step: a creeping tip may stick beyond mu_s f_n",
    ),
    (
        "sim/contact/contact_labels.cc",
        "frame_.slip_angle += @@slip_rate_ * dt@@slip_rate_@@;",
        "missing factor: the slip angle adds rates",
    ),
    (
        "sim/contact/contact_labels.cc",
        "@@field.update_contact_point(last);@@;@@",
        "missing step: normal of a sleeping element",
    ),
    (
        "sim/contact/unit_rules.cc",
        "moment = @@moment_sum - (x_sum * vy_sum - y_sum * vx_sum) / n@@moment_sum@@;",
        "missing term: moment about the origin instead of the centre",
    ),
    (
        "sim/contact/dashpot.cc",
        "force.h_z[i] -= @@tangential_rate@@normal_rate@@ * before_",
        "wrong variable: dashpot along z",
    ),
    (
        "sim/contact/active_set.cc",
        "wakes_at_[first / lanes] = @@travel_ + room@@travel_ + 2.0 * room@@;",
        "constant: groups wake too late",
    ),
    (
        "sim/contact/field.cc",
        "@@to.before.contact.set(i, to.contact.at(i) - way);@@;@@",
        "missing step: an element handed over has no earlier contact point",
    ),
    (
        "sim/contact/several_surfaces.cc",
        "(first == none || @@way(k) > way(first)@@way(k) < way(first)@@)",
        "comparison: the farthest surface instead of the first",
    ),
    (
        "sim/contact/label_kernel.cc",
        "c = @@raw > 0.0 ? raw : none@@raw@@, d = none;",
        "missing condition: separated elements pull",
    ),
    # sim/effects
    (
        "sim/effects/ageing.cc",
        "== stick ? @@stuck_for_[i] + elements.dt@@elements.dt@@ : 0.0",
        "missing term: the time of stick does not add up",
    ),
    (
        "sim/effects/asperities.cc",
        "place += @@way@@2.0 * way@@;",
        "constant: half as many asperities",
    ),
    (
        "sim/effects/inertia.cc",
        "@@drive.limit[1] = drive.limit[0] * drive.f_normal[1] / drive.f_normal[0];@@;@@",
        "missing step: limit of a tip that separates in the step",
    ),
    (
        "sim/effects/load_dependent_friction.cc",
        "(reference_ * @@share_[i]@@1.0@@)",
        "missing factor: an element of a unit is taken as a whole unit",
    ),
    (
        "sim/effects/patchy_friction.cc",
        "sd * map.at(u, v) - @@0.5 * sd * sd@@0.0@@)",
        "missing term: mean of a log-normal factor",
    ),
    (
        "sim/effects/roughness.cc",
        "gap[i] -= @@nz[i] == 1.0 ? height : 0.0@@height@@;",
        "missing condition: the sides of a box are rough",
    ),
    (
        "sim/effects/stick_slip.cc",
        "if (@@!breaks_away_ && holds()@@holds()@@) return stick();",
        "missing condition: a tip that was just released sticks again",
    ),
    (
        "sim/effects/viscoelastic.cc",
        "branch(i, c) = @@relaxing_ * k * gain_ * now[c]@@relaxing_ * k * now[c]@@ + history",
        "missing factor: the force of a Maxwell branch",
    ),
    (
        "sim/effects/viscous_friction.cc",
        "gain_ / (@@(speed_ + speed) * factor(speed)@@speed_ * factor(speed)@@)",
        "missing term: slope of the rate law",
    ),
    (
        "sim/effects/texture.cc",
        "std::min(shortest, @@2.0 * edge_ * wavelength_@@edge_ * wavelength_@@)",
        "constant: longest step on a flank",
    ),
    (
        "sim/effects/stribeck.cc",
        "math::pow(v / speed_, @@exponent_@@1.0@@)",
        "constant instead of a parameter",
    ),
    (
        "sim/effects/skin/bessel.cc",
        "k + 1 == nodes ? @@1.0@@2.0@@ : 2.0;",
        "constant: weight of the middle",
    ),
    # sensors
    (
        "sensors/electronics/band_pass.h",
        "(@@low_.mean - low_.keeps@@low_.mean + low_.keeps@@) * before",
        "sign: weight of the earlier value",
    ),
    (
        "sensors/electronics/low_pass.cc",
        "std::sqrt(@@std::numbers::sqrt2 - 1.0@@std::numbers::sqrt2@@)",
        "missing term: corner of two poles",
    ),
    (
        "sensors/electronics/noise.cc",
        "covariance = @@xu_ * (xx_ - uu_)@@xu_ * (xx_ + uu_)@@;",
        "sign: covariance of a step of red noise",
    ),
    (
        "sensors/electronics/quantisation.cc",
        '("bits"))) - @@1.0@@0.0@@;',
        "constant: one code too many",
    ),
    (
        "sensors/electronics/scan.cc",
        "@@last[v] = now;@@;@@",
        "missing step: the previous sample stays the first",
    ),
    (
        "sensors/electronics/skewed_noise.cc",
        "n += @@tail_ * math::log1p(-tail / tail_share_)@@-tail_ * math::log1p(-tail / tail_share_)@@;",
        "sign: the tail points up",
    ),
    (
        "sensors/electronics/valid_range.cc",
        "flags_[@@flag_[v]@@std::size_t{0}@@] = 1.0F;",
        "index: the flag of another unit",
    ),
    (
        "sensors/piezo_skin/piezo_skin.cc",
        "until_position() = @@label_stride_@@1.0@@;",
        "constant: the stage is read at every sample",
    ),
    (
        "sensors/papillarray/papillarray.cc",
        "@@if (rotating && pillar == centre_pillar) continue;@@;@@",
        "missing condition: the centre pillar counts in a turn",
    ),
    (
        "sensors/myrmex/myrmex.cc",
        "felt + share[k] * (@@slow[k] - felt@@felt - slow[k]@@)",
        "sign: creep",
    ),
    (
        "sensors/taxels/taxels.cc",
        "{ return value < @@point[0]@@point[1]@@; }",
        "index: input and output of the curve",
    ),
    (
        "sensors/nib_pad/nib_pad.cc",
        "return @@turn * place.east < 0@@turn * place.east <= 0@@;",
        "comparison: electrodes of a cluster",
    ),
    (
        "sensors/magnetic_skin/magnetic_skin.cc",
        "field[2] += @@along * z - cubed@@along * z + cubed@@;",
        "sign: axial field of a dipole",
    ),
    (
        "sensors/gel_markers/gel_markers.cc",
        "skin_[e][axis] = now + back * (@@last_[e][axis] - now@@now - last_[e][axis]@@);",
        "sign: a frame shows the future",
    ),
    (
        "sensors/biotac_sp/biotac_sp.cc",
        "volume += @@std::min(depth, core_gap_)@@depth@@ * area_[i];",
        "missing limit: the skin passes through the core",
    ),
    # detectors
    (
        "detectors/channel.cc",
        "if (@@seen_ >= frames_@@seen_ > frames_@@) rates_[i]",
        "comparison: the first rate comes a frame late",
    ),
    (
        "detectors/flip.cc",
        "replace(draw < @@0.5 * probability_@@probability_@@ ? 1 : 2)",
        "constant: always the same other class",
    ),
    (
        "detectors/force_ratio.cc",
        "if (!(@@force.normal >= touch_@@force.normal > touch_@@)) continue;",
        "comparison: a unit at the threshold",
    ),
    (
        "detectors/marker_slip.cc",
        "if (!touches_[i]) @@began = now;@@;@@",
        "missing step: displacement from the unloaded place, not from the touch",
    ),
    (
        "detectors/resampling.cc",
        "if (@@step > longest@@step < longest@@) resampling.made_up = true;",
        "comparison: which gaps are made up",
    ),
    (
        "detectors/shear_rate.cc",
        "unit.peak >= loading_ && @@rate >= following_ * unit.peak@@rate >= following_@@)",
        "missing factor: a share is taken as a rate",
    ),
    (
        "detectors/yardstick/moving_statistics.cc",
        "earliest = @@seen_ % frames_@@(seen_ + 1) % frames_@@;",
        "index: the second oldest sample",
    ),
    (
        "detectors/yardstick/yardsticks.cc",
        "level += @@std::abs(past.mean(3 * unit + 2))@@past.mean(3 * unit + 2)@@;",
        "missing step: levels of opposite sign cancel",
    ),
    (
        "detectors/spectral/band_energy.cc",
        "slips_ = rms >= (slips_ ? @@release_@@threshold_@@ : threshold_);",
        "wrong variable: no hysteresis",
    ),
    (
        "detectors/spectral/spectral_features.cc",
        "static_cast<std::size_t>(last - first) + @@1@@std::size_t{0}@@};",
        "constant: the last bin is left out",
    ),
    (
        "detectors/nib/slip_detectors.cc",
        "count_ > 0 && @@time - last_flag_ > settings_.patience@@time > settings_.patience@@)",
        "missing term: patience since the start",
    ),
    (
        "detectors/hd/features.cc",
        "if (@@(root + bit) * (root + bit) <= value@@(root + bit) * (root + bit) < value@@) root",
        "comparison: root of a square number",
    ),
    (
        "detectors/network/frames.cc",
        "for (auto channel = channels.begin(); channel != found; ++channel) @@first += channel->size();@@++first;@@",
        "wrong variable: channels of one value each",
    ),
    # controllers
    (
        "controllers/force_ratio_controller.cc",
        "largest_ ? @@grip * largest_ratio(input.frame)@@largest_ratio(input.frame)@@ : shear",
        "missing factor: a ratio is taken as a force",
    ),
    (
        "controllers/force_ratio_controller.cc",
        "if (@@normal >= touch_@@normal > 0.0@@) ratio",
        "constant instead of a parameter: ratio of a unit that barely touches",
    ),
    (
        "controllers/grip.cc",
        "loosen_ && grip >= @@target + force_per_count_@@target@@)",
        "missing term: no count of hysteresis",
    ),
    (
        "controllers/grip.cc",
        "std::floor((@@ceiling_ - grip@@ceiling_@@) / force_per_count_)",
        "missing term: the ceiling is exceeded",
    ),
    (
        "controllers/grip.cc",
        "position_ = loosen_ ? @@position@@std::max(position_, position)@@ :",
        "wrong variable: a follower that may loosen does not",
    ),
    (
        "controllers/reorient.cc",
        "if (!settled || !(@@features_.in(slip, fr) < fr_slip_@@features_.in(slip, fr) > fr_slip_@@)) {",
        "comparison: the box turns",
    ),
    (
        "controllers/reorient.cc",
        "@@rest_ /= rests_;@@;@@",
        "missing step: the tare is a sum",
    ),
    (
        "controllers/step_on_slip.cc",
        "slips_ = slips ? std::min(slips_ + 1, debounce_) : @@0@@slips_@@;",
        "missing step: the count of slips is not reset",
    ),
    (
        "controllers/step_on_slip.cc",
        "if (wanted && @@grip + force_per_count_@@grip@@ <= ceiling_) {",
        "missing term: the ceiling is exceeded by a count",
    ),
    (
        "controllers/timed_grip.cc",
        "(time - @@before[0]@@0.0@@) /",
        "missing term: time since the start",
    ),
    # tools/dataset
    (
        "tools/dataset/record/slip_path.cc",
        "labels.slip_distance[@@k - units@@k - 1@@]",
        "index: the unit before instead of the row before",
    ),
    (
        "tools/dataset/record/sample_timing.cc",
        "if (@@steps.size() % 2 == 1@@true@@) return *middle;",
        "missing condition: median of an even number",
    ),
    (
        "tools/dataset/record/sample_timing.cc",
        "return roundest(@@steps / (span + uncertain)@@steps / span@@,",
        "missing term: lower end of the rate",
    ),
    (
        "tools/dataset/record/trial_outcome.cc",
        "@@outcome.detection_delay = std::numeric_limits<double>::quiet_NaN();@@;@@",
        "missing step: an early alarm keeps its delay",
    ),
    (
        "tools/dataset/trial_difference.cc",
        "library_rounding * @@std::max(larger, scale)@@larger@@ +",
        "missing limit: rounding relative to a value near zero",
    ),
    (
        "tools/dataset/writer.cc",
        "closing_bytes(held + 1) + @@groups@@std::uint64_t{0}@@ > shard_limit_;",
        "missing term: a shard exceeds its size",
    ),
    (
        "tools/dataset/shard_set.cc",
        "@@if (same->second.digest == trial.digest) continue;@@;@@",
        "missing step: equal trials count as equal within rounding",
    ),
    (
        "tools/dataset/batches.cc",
        "@@sync_folder_of(name);@@;@@",
        "missing step: the name of a batch may be lost with the power",
    ),
    (
        "tools/dataset/content_check.cc",
        "if (reader_->schema(file) > @@1@@2@@ && hexadecimal(found)",
        "constant: trials of schema 2 are not checked",
    ),
    (
        "tools/dataset/header.cc",
        "i < test ? masks.test : @@i < test + valid@@i < valid@@ ?",
        "missing term: size of the mask valid",
    ),
    # tools/trial
    (
        "tools/trial/control_loop.cc",
        "if (gripper.read_due(time) && @@gripper.next_read() <= gripper.next_write()@@gripper.next_read() < gripper.next_write()@@) {\n      read();\n      command_",
        "comparison: write before read at the same time",
    ),
    (
        "tools/trial/control_loop.cc",
        "std::max(before.position, @@input_.gripper.position@@before.position@@))",
        "wrong variable: a command below the measured position counts as tightening",
    ),
    (
        "tools/trial/control_loop.cc",
        "has_come(@@under_way_[i].time + under_way_[i].latency@@under_way_[i].time@@, time)",
        "missing term: the latency of a detector",
    ),
    (
        "tools/trial/judge.cc",
        "if (@@event.time >= judged_from()@@true@@) keep_earliest(outcome_.judged_slip_time",
        "missing condition: slip before the lift is judged",
    ),
    (
        "tools/trial/judge.cc",
        "turn ? @@std::min(turn->least_tilt, now.tilt)@@now.tilt@@ : now.tilt",
        "missing step: the last tilt instead of the least",
    ),
    (
        "tools/trial/recorder.cc",
        "unit_heights.push_back(@@tip.z() - ahead@@tip.z()@@);",
        "missing term: heights from another origin",
    ),
    (
        "tools/trial/recorder.cc",
        "!what_.empty() && @@time_ <= time[row]@@time_ >= time[row]@@) return;",
        "comparison: the last bad row instead of the first",
    ),
    (
        "tools/trial/sampler.cc",
        "sensor.feels_every_tick() ? @@1@@stride@@ : stride",
        "wrong variable: a filter sees only samples",
    ),
    (
        "tools/trial/sweep/unit_sampling.cc",
        "* k) > @@0.9@@0.5@@) sampling.harmonic = h;",
        "constant: which harmonic aliases",
    ),
    (
        "tools/trial/sweep/sweep_results.cc",
        "@@if (summary.resumed) ++summary_.resumed;@@;@@",
        "missing step: resumed trials are not counted",
    ),
    # tools/eval
    (
        "tools/eval/metrics.cc",
        "row > before && @@truth.time[begin] - truth.time[row - 1] < slip_lead@@false@@)",
        "missing step: alarms just before a slip",
    ),
    (
        "tools/eval/metrics.cc",
        "alarm > truth.first_slip - @@grace@@0.0@@;",
        "missing term: the grace period",
    ),
    (
        "tools/eval/metrics.cc",
        "if (@@known || !slips(seen)@@true@@) seen_before = slips(seen);",
        "missing condition: an alarm in unknown samples",
    ),
    (
        "tools/eval/metrics.cc",
        'set("false_alarms_per_minute", @@60.0@@1.0@@ *',
        "constant: unit of the rate",
    ),
    (
        "tools/eval/metrics.cc",
        "? state : @@std::max(state, held)@@held@@;",
        "missing step: incipient slip that becomes gross",
    ),
    (
        "tools/eval/metrics.cc",
        "if (@@starts || states[row] == PadState::no_contact@@starts@@) slipped = false;",
        "missing condition: a lost contact",
    ),
    (
        "tools/eval/replay.cc",
        "const bool fresh = @@now.time != last_@@true@@;",
        "missing condition: a held estimate is scored again",
    ),
    (
        "tools/eval/yardsticks.cc",
        "k + 1 < curve.size() ? @@curve[k + 1].threshold@@curve[k].threshold@@ : 0.0",
        "index: the threshold lies on a sample",
    ),
    (
        "tools/eval/detect.cc",
        ".is_null() ? @@-1.0@@1e9@@ :",
        "constant: trials without a figure are the worst",
    ),
    (
        "tools/eval/evaluate.cc",
        "replayed.probability[row] >= @@threshold@@0.5@@)",
        "constant instead of a parameter",
    ),
)
