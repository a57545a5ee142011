"""The published networks, and those of scenes/learn, as torch.nn.Module.

Each maps clips [N, T, inputs] of N sequences of T frames to logits [N, T - history + 1, classes].
`history` is the number of frames that an answer depends on, 1 unless the class states otherwise. A
network with a state takes it as a second argument, None at the start of a sequence, and returns
(logits, state): so the same module is trained on clips and runs frame by frame in a loop.
"""

# PyTorch's layers and operators are typed only in part, depending on the release.
# mypy: disable-error-code="no-untyped-call,no-any-return,attr-defined,unused-ignore"

from __future__ import annotations

from itertools import pairwise

import torch
from torch import Tensor, nn

State = tuple[Tensor, ...] | None


def each_frame(layer: nn.Module, frames: Tensor) -> Tensor:
    """Applies a layer to every frame separately.

    Args:
        layer: maps [M, ...]
        frames: [N, T, ...]

    Returns:
        [N, T, ...]
    """
    answers: Tensor = layer(frames.flatten(0, 1))
    return answers.reshape(*frames.shape[:2], *answers.shape[1:])


def windows(frames: Tensor, length: int) -> Tensor:
    """All windows of `length` consecutive frames.

    Args:
        frames: [N, T, F], T >= length
        length: frames per window

    Returns:
        [N, T - length + 1, length, F]
    """
    if frames.shape[1] == length:  # a step in the loop, which the exporter can trace
        return frames.unsqueeze(1)
    return frames.unfold(1, length, 1).transpose(2, 3)


def signed_log(values: Tensor) -> Tensor:
    """Sign times ln(1 + magnitude): as asinh, which ONNX files of PyTorch 1.13 do not have."""
    return torch.sign(values) * torch.log(1 + values.abs())


def dense(*widths: int) -> nn.Sequential:
    """Linear layers from width to width, each but the first input followed by ReLU."""
    layers: list[nn.Module] = []
    for inputs, outputs in pairwise(widths):
        layers += [nn.Linear(inputs, outputs), nn.ReLU()]
    return nn.Sequential(*layers)


class GruStack(nn.Module):
    """A stack of GRUs, each with its own state."""

    def __init__(self, inputs: int, units: int, layers: int) -> None:
        super().__init__()
        self.layers = nn.ModuleList(
            nn.GRU(inputs if i == 0 else units, units, batch_first=True) for i in range(layers)
        )

    def forward(self, frames: Tensor, state: State = None) -> tuple[Tensor, tuple[Tensor, ...]]:
        """[N, T, inputs] and one [1, N, units] per layer to [N, T, units] and the next states."""
        after = []
        for i, layer in enumerate(self.layers):
            frames, one = layer(frames, None if state is None else state[i])
            after.append(one)
        return frames, tuple(after)


class FrameGru(nn.Module):
    """Linear layer, GRUs, linear layer: piezo_grasp, nib_slip, grasp_gru, biotac_gru. Not published.

    | layer | output |
    |---|---|
    | frame | inputs |
    | linear, ReLU | width |
    | GRU, `layers` times | width |
    | linear | classes |
    """

    def __init__(self, inputs: int, classes: int, width: int = 48, layers: int = 1) -> None:
        super().__init__()
        self.first = dense(inputs, width)
        self.memory = GruStack(width, width, layers)
        self.last = nn.Linear(width, classes)

    def forward(self, frames: Tensor, state: State = None) -> tuple[Tensor, tuple[Tensor, ...]]:
        """Returns logits, and the state if the network has one (see the module)."""
        hidden, state = self.memory(self.first(frames), state)
        return self.last(hidden), state


class PiezoMlp(nn.Module):
    """MLP of the piezoelectric skin, each spectrum by itself.

    See [ayral2023], sections IV.A, IV.B and Table I.

    Four layers and a linear one to two classes give the numbers of parameters that Table I prints.

    | layer | MLP 32 | MLP 128 |
    |---|---|---|
    | spectrum of 20 ms, 50 to 600 Hz | 12 | 12 |
    | linear, ReLU, four times | 32 | 128 |
    | linear | 2 | 2 |
    """

    def __init__(self, inputs: int, classes: int, width: int) -> None:
        super().__init__()
        self.layers = nn.Sequential(
            dense(inputs, width, width, width, width), nn.Linear(width, classes)
        )

    def forward(self, frames: Tensor) -> Tensor:
        """Returns logits, and the state if the network has one (see the module)."""
        logits: Tensor = self.layers(frames)
        return logits


class PiezoTcn(nn.Module):
    """Causal convolutions of the piezoelectric skin ([ayral2023], Table I: TCN 128, kernel 8).

    Without padding: the first answer comes after all frames that it depends on, in training and in
    the loop.

    | layer | output |
    |---|---|
    | 29 spectra | 29 x 12 |
    | convolution over 8 frames, ReLU, four times | 22, 15, 8, 1 x 128 |
    | linear | 2 |
    """

    def __init__(
        self, inputs: int, classes: int, channels: int = 128, kernel: int = 8, layers: int = 4
    ) -> None:
        super().__init__()
        self.history = 1 + layers * (kernel - 1)
        convolutions: list[nn.Module] = []
        for i in range(layers):
            convolutions += [nn.Conv1d(inputs if i == 0 else channels, channels, kernel), nn.ReLU()]
        self.convolutions = nn.Sequential(*convolutions)
        self.last = nn.Linear(channels, classes)

    def forward(self, frames: Tensor) -> Tensor:
        """Returns logits, and the state if the network has one (see the module)."""
        logits: Tensor = self.last(self.convolutions(frames.transpose(1, 2)).transpose(1, 2))
        return logits


class PiezoGru(nn.Module):
    """GRUs of the piezoelectric skin ([ayral2023], Table I: FFT GRU 32, raw GRU 32).

    | layer | FFT GRU 32 | raw GRU 32 |
    |---|---|---|
    | frame at 100 Hz | spectrum, 12 | signal, 1 |
    | GRU, four times | 32 | 32 |
    | linear | 2 | 2 |
    """

    def __init__(self, inputs: int, classes: int, units: int = 32, layers: int = 4) -> None:
        super().__init__()
        self.memory = GruStack(inputs, units, layers)
        self.last = nn.Linear(units, classes)

    def forward(self, frames: Tensor, state: State = None) -> tuple[Tensor, tuple[Tensor, ...]]:
        """Returns logits, and the state if the network has one (see the module)."""
        hidden, state = self.memory(frames, state)
        return self.last(hidden), state


class PiezoSlip(nn.Module):
    """piezo_slip: the signal's level and changes with their signs, and its spectrum, through two GRUs. Not published.

    A level that rises or falls steadily would leak into all bins, so the straight line of a frame is removed before its spectrum.

    | layer | output |
    |---|---|
    | frame of 20 ms | 200 |
    | `signed_log` of four means of 5 ms, of their three differences | 4, 3 |
    | log power of the bins from 50 Hz to 1.5 kHz | 30 |
    | batch norm | 37 |
    | linear, ReLU | 48 |
    | GRU, twice | 48 |
    | linear | 2 |
    """

    def __init__(self, inputs: int, classes: int, bins: int = 30, parts: int = 4) -> None:
        super().__init__()
        self.parts = parts
        self.register_buffer("waves", _waves(inputs, bins))
        self.norm = nn.BatchNorm1d(2 * parts - 1 + bins)
        self.rest = FrameGru(2 * parts - 1 + bins, classes, layers=2)

    def forward(self, frames: Tensor, state: State = None) -> tuple[Tensor, tuple[Tensor, ...]]:
        """Returns logits, and the state if the network has one (see the module)."""
        levels = frames.reshape(*frames.shape[:2], self.parts, -1).mean(3)
        changes = levels[:, :, 1:] - levels[:, :, :-1]
        features = torch.cat(
            (
                signed_log(100 * levels),
                signed_log(100 * changes),
                _log_power(frames, self.get_buffer("waves"), 1e-6),
            ),
            2,
        )
        features = self.norm(features.flatten(0, 1)).reshape(features.shape)
        after: tuple[Tensor, tuple[Tensor, ...]] = self.rest(features, state)
        return after


class PiezoForce(nn.Module):
    """piezo_force: the force on the skin and the spectrum of the signal, through a GRU.

    The force continues or breaks off. Not published.

    The amplifier is a high-pass of first order (sensors/piezo_skin). Its inverse gives the change of
    the force [counts] from the signal y [counts]; the time constant is 1/(2 pi corner):

        force(t) - force(s) = y(t) - y(s) + integral of y from s to t / time constant

    A load that holds rises as steadily as the motion. When the pad slips, the force stays behind the
    motion or falls. A level that rises or falls steadily would leak into all bins, so the straight
    line of a frame is removed before its spectrum. Before the first frame the signal counts as 0, so
    the changes in the first 64 frames of a clip that starts under load are false.

    | layer | output |
    |---|---|
    | frame of 5 ms; states hold three earlier frames and 64 earlier means | 50 |
    | change of the force over 5 to 160 ms, in deviations of its noise, `signed_log` | 6 |
    | its difference from the change over the same time before, `signed_log` | 6 |
    | ratio of both changes | 6 |
    | log power of 20 ms from 50 Hz to 1.5 kHz | 30 |
    | log power of 5 ms from 200 Hz to 2 kHz | 10 |
    | batch norm | 58 |
    | linear, ReLU | 64 |
    | GRU | 64 |
    | linear | 2 |

    Args:
        lags: frames
        period: s, of a frame
        noise: counts, of a sample
        corner: Hz, of the amplifier
    """

    def __init__(
        self,
        inputs: int,
        classes: int,
        lags: tuple[int, ...] = (1, 2, 4, 8, 16, 32),
        period: float = 5e-3,
        noise: float = 70.0,
        corner: float = 3.0,
    ) -> None:
        super().__init__()
        self.scale = 1 / noise
        # Filters [2 lags, 1, history + 1] of the means: the change over a lag, and that over the same time before.
        history = 2 * lags[-1]
        # The force at each frame less that at the first, from all means.
        force = torch.zeros(history + 1, history + 1, dtype=torch.float64)
        share = 2 * torch.pi * corner * period
        for i in range(history + 1):
            force[i, i] += 1
            force[i, 0] -= 1
            force[i, :i] += share / 2
            force[i, 1 : i + 1] += share / 2
        now = [force[history] - force[history - lag] for lag in lags]
        then = [force[history - lag] - force[history - 2 * lag] for lag in lags]
        filters = torch.stack(now + then)
        filters = filters / filters.norm(dim=1, keepdim=True) * inputs**0.5
        self.register_buffer("filters", filters.float().unsqueeze(1))
        self.earlier = history
        self.register_buffer("long", _waves(4 * inputs, 30))
        self.register_buffer("short", _waves(inputs, 10))
        features = 3 * len(lags) + 40
        self.norm = nn.BatchNorm1d(features)
        self.rest = FrameGru(features, classes, width=64)

    def measures(self, frames: Tensor, means: Tensor) -> Tensor:
        """Features [N, T, 58] of frames [N, T + 3, inputs] and means [N, T + 2 greatest lag].

        Both include the earlier ones.
        """
        count = frames.shape[1] - 3
        changes = nn.functional.conv1d(means.unsqueeze(1), self.get_buffer("filters")).transpose(
            1, 2
        )
        now, then = changes.chunk(2, 2)
        ratio = torch.clamp(
            now * then / (then**2 + 9), -2, 2
        )  # 9: below 3 deviations the change before is noise
        joined = torch.cat([frames[:, k : k + count] for k in range(4)], 2)
        # The noise has a power of 2 in each bin, far above 0.03, which avoids the logarithm of 0.
        powers = [
            _log_power(joined, self.get_buffer("long"), 0.03),
            _log_power(frames[:, 3:], self.get_buffer("short"), 0.03),
        ]
        return torch.cat((signed_log(now), signed_log(now - then), ratio, *powers), 2)

    def forward(self, frames: Tensor, state: State = None) -> tuple[Tensor, tuple[Tensor, ...]]:
        """Returns logits, and the state if the network has one (see the module)."""
        frames = frames.mul(self.scale)
        if state is None:
            state = (
                frames.new_zeros((frames.shape[0], 3, frames.shape[2])),
                frames.new_zeros((frames.shape[0], self.earlier)),
            )
        means = torch.cat((state[1], frames.mean(2)), 1)
        frames = torch.cat((state[0], frames), 1)
        features = self.measures(frames, means)
        features = self.norm(features.flatten(0, 1)).reshape(features.shape)
        logits, after = self.rest(features, state[2:] or None)
        return logits, (frames[:, -3:], means[:, -self.earlier :], *after)


def _waves(samples: int, bins: int) -> Tensor:
    """Cosines and sines [samples, 2 bins] of the first bins of a frame, without its straight line."""
    time = torch.arange(samples, dtype=torch.float64)
    line = torch.stack((torch.ones_like(time), time - time.mean()))
    line = line / line.norm(dim=1, keepdim=True)
    angle = 2 * torch.pi * time[:, None] * torch.arange(1, bins + 1, dtype=torch.float64) / samples
    waves = torch.cat((angle.cos(), angle.sin()), 1) * (2 / samples) ** 0.5
    return (waves - line.t() @ (line @ waves)).float()


def _log_power(frames: Tensor, waves: Tensor, least: float) -> Tensor:
    """Log of the power of each bin of `_waves`, plus `least`."""
    cosine, sine = torch.matmul(frames, waves).chunk(2, 2)
    return torch.log(cosine**2 + sine**2 + least)


class PapillarrayGru(nn.Module):
    """The network of RedmondLabUCD/Incipient-Slip-Detection-PapillArray.

    | layer | output |
    |---|---|
    | 40 rows of the tangential forces of eight pillars | 640 |
    | linear, batch norm, ReLU | 1024 |
    | linear, batch norm, ReLU | 128 |
    | GRU | 128 |
    | linear, batch norm, ReLU | 256 |
    | linear, batch norm, ReLU | 128 |
    | linear | 2 |
    """

    def __init__(self, inputs: int, classes: int) -> None:
        super().__init__()

        def block(before: int, after: int) -> list[nn.Module]:
            return [nn.Linear(before, after), nn.BatchNorm1d(after), nn.ReLU()]

        self.encoder = nn.Sequential(*block(inputs, 1024), *block(1024, 128))
        self.memory = nn.GRU(128, 128, batch_first=True)
        self.decoder = nn.Sequential(*block(128, 256), *block(256, 128), nn.Linear(128, classes))

    def forward(self, frames: Tensor, state: State = None) -> tuple[Tensor, tuple[Tensor, ...]]:
        """Returns logits, and the state if the network has one (see the module)."""
        hidden, after = self.memory(
            each_frame(self.encoder, frames), None if state is None else state[0]
        )
        return each_frame(self.decoder, hidden), (after,)


class UnitsEncoder(nn.Module):
    """Units by the same weights, pooled: any number of units, in any order, to 48 values.

    | layer | output |
    |---|---|
    | features of each unit (transform `units`) | units x features |
    | batch norm of each feature | units x features |
    | linear, ReLU | units x 32 |
    | the same, with mean and maximum of all units | units x 96 |
    | linear, ReLU | units x 48 |
    | mean and maximum of all units | 96 |
    | linear, ReLU | 48 |
    """

    def __init__(self, features: int) -> None:
        super().__init__()
        self.features = features
        self.norm = nn.BatchNorm1d(features)
        self.unit = dense(features, 32)
        self.beside = dense(96, 48)
        self.pooled = dense(96, 48)

    def forward(self, frames: Tensor) -> Tensor:
        """[N, T, units x features] to [N, T, 48]."""
        units = frames.reshape(*frames.shape[:2], -1, self.features)
        units = self.norm(units.reshape(-1, self.features)).reshape(units.shape)
        own = self.unit(units)
        both = torch.cat((own.mean(2, keepdim=True), own.amax(2, keepdim=True)), 3)
        own = self.beside(torch.cat((own, both.expand(-1, -1, own.shape[2], -1)), 3))
        pooled: Tensor = self.pooled(torch.cat((own.mean(2), own.amax(2)), 2))
        return pooled


class SlipGru(nn.Module):
    """slip_gru: three axes of each unit, their ratio and rates, through a GRU.

    Each unit has the same weights. Not published.

    | layer | output |
    |---|---|
    | `UnitsEncoder` | 48 |
    | GRU | 48 |
    | linear | 2 |
    """

    def __init__(self, inputs: int, classes: int, features: int) -> None:
        super().__init__()
        self.encoder = UnitsEncoder(features)
        self.memory = nn.GRU(48, 48, batch_first=True)
        self.last = nn.Linear(48, classes)

    def forward(self, frames: Tensor, state: State = None) -> tuple[Tensor, tuple[Tensor, ...]]:
        """Returns logits, and the state if the network has one (see the module)."""
        hidden, after = self.memory(self.encoder(frames), None if state is None else state[0])
        return self.last(hidden), (after,)


def grid_places(columns: int, rows: int) -> Tensor:
    """Places [columns rows, 2] of a grid around its centre, in pitches.

    Rows go from +Y to -Y, and in each from -X to +X.
    """
    across = torch.arange(columns, dtype=torch.float32) - (columns - 1) / 2
    along = (rows - 1) / 2 - torch.arange(rows, dtype=torch.float32)
    return torch.stack((across.repeat(rows), along.repeat_interleave(columns)), 1)


def changes_of(frames: Tensor, before: Tensor, lags: tuple[int, ...]) -> Tensor:
    """Changes over `lags` frames.

    Args:
        frames: [N, T, F]
        before: the frames before them [N, lags[-1], F]; 0 before the first frame, where no change
            is known
        lags: numbers of frames, ascending

    Returns:
        [N, T, lags, F]
    """
    joined = torch.cat((before, frames), 1)
    earlier = torch.stack(
        [joined[:, lags[-1] - lag : lags[-1] - lag + frames.shape[1]] for lag in lags], 2
    )
    return torch.where(earlier.eq(0), torch.zeros_like(earlier), frames.unsqueeze(2) - earlier)


def with_latest(
    network: NibRigid | RigidSlip, frames: Tensor, state: State
) -> tuple[Tensor, tuple[Tensor, ...]]:
    """Runs a network whose state starts with the latest frames."""
    before = (
        frames.new_zeros((frames.shape[0], network.lags[-1], frames.shape[2]))
        if state is None
        else state[0]
    )
    logits, after = network.after(
        *network.measures(frames, before), None if state is None else state[1:]
    )
    return logits, (torch.cat((before, frames), 1)[:, -network.lags[-1] :], *after)


class RigidFit:
    """The rigid motion in the plane that fits fields of displacements best, and the departure from it.

    Args:
        x, y: [..., units]
        weight: [..., units], or of a shape that is broadcast to it
        places: [units, 2], in pitches
        least: sizes below this are noise; in the unit of x and y
    """

    def __init__(self, x: Tensor, y: Tensor, weight: Tensor, places: Tensor, least: float) -> None:
        self.weight = weight
        self.count = weight.sum(-1, keepdim=True) + 1e-3
        across, along = (
            places[:, 0] - self.mean(places[:, 0]),
            places[:, 1] - self.mean(places[:, 1]),
        )
        right, up = self.mean(x), self.mean(y)
        self.turn = self.mean(across * (y - up) - along * (x - right)) / self.mean(
            across**2 + along**2
        ).add(1e-3)
        rigid_x, rigid_y = right - self.turn * along, up + self.turn * across
        rest_x, rest_y = x - rigid_x, y - rigid_y
        self.rigid = torch.sqrt(
            rigid_x**2 + rigid_y**2 + least**2
        )  # size of the rigid part of each unit
        self.rest = torch.sqrt(
            rest_x**2 + rest_y**2 + least**2
        )  # size of the departure of each unit
        self.along_rigid = (
            rest_x * rigid_x + rest_y * rigid_y
        ) / self.rigid  # its part along the rigid motion
        self.size = self.mean(self.rigid)
        self.departure = torch.sqrt(self.mean(self.rest**2))

    def mean(self, values: Tensor) -> Tensor:
        """Weighted mean of the units [..., 1]."""
        return (self.weight * values).sum(-1, keepdim=True) / self.count


class UnitsAndWhole(nn.Module):
    """Values of units through the same weights, pooled, with values of the whole contact, through a GRU.

    Args:
        own: values of each unit
        whole: values of the whole contact
    """

    def __init__(self, own: int, whole: int, classes: int) -> None:
        super().__init__()
        self.own_norm, self.whole_norm = nn.BatchNorm1d(own), nn.BatchNorm1d(whole)
        self.own = dense(own, 16)
        self.rest = FrameGru(2 * 16 + whole, classes)

    def forward(
        self, own: Tensor, weight: Tensor, whole: Tensor, state: State = None
    ) -> tuple[Tensor, tuple[Tensor, ...]]:
        """[N, T, units, own], [N, T, units, 1] and [N, T, whole] to logits and the state."""
        own = self.own(self.own_norm(own.reshape(-1, own.shape[3])).reshape(own.shape))
        whole = self.whole_norm(whole.flatten(0, 1)).reshape(whole.shape)
        pooled = torch.cat(
            ((weight * own).sum(2) / (weight.sum(2) + 1e-3), (weight * own).amax(2), whole), 2
        )
        after: tuple[Tensor, tuple[Tensor, ...]] = self.rest(pooled, state)
        return after


class RigidSlip(nn.Module):
    """papillarray_slip, taxels_slip, gel_slip: departure from a rigid motion, through a GRU.

    The displacements of an array depart from such a motion. Not published. Forces of units that lean like
    springs are proportional to displacements.

    The units that stick to an object move as a rigid body. Slip shows as a departure from that
    motion, first where the array is pressed least. The rigid motion is fitted to the units in
    contact, for the displacement from rest and for its changes.

    | layer | output |
    |---|---|
    | displacement of the units, m, or forces, N | units x 3 |
    | displacement from rest, and changes over `lags` frames, which a state holds | fields |
    | of each unit: depth, contact, ratio of shear to depth | units x 3 |
    | of each unit and field: rigid part, departure, its part along it, depth | units x 4 fields |
    | batch norm, linear, ReLU; weighted mean and maximum of all units | 2 x 16 |
    | of each field: size of the motion, turn, departure, its regression on depth | 4 fields |
    | of the contact: depth, spread of the depth, size | 3 |
    | batch norm; linear of all, ReLU | 48 |
    | GRU | 48 |
    | linear | 2 |

    Args:
        columns, rows: of the array
        upwards: True if the rows go from -Y to +Y
        lags: frames, in ascending order
        noise: m of a displacement, or N of a force; a unit with a depth of 6 times as much is in contact
    """

    def __init__(
        self,
        inputs: int,
        classes: int,
        columns: int,
        rows: int,
        lags: tuple[int, ...],
        noise: float,
        upwards: bool = False,
    ) -> None:
        super().__init__()
        self.lags, self.scale = lags, 1 / noise
        places = grid_places(columns, rows)
        self.register_buffer("places", places * torch.tensor([1.0, -1.0]) if upwards else places)
        fields = 1 + len(lags)
        self.after = UnitsAndWhole(3 + 4 * fields, 3 + 4 * fields, classes)

    def measures(self, frames: Tensor, before: Tensor) -> tuple[Tensor, Tensor, Tensor]:
        """Values of the units and of the contact, from frames [N, T, inputs].

        With the frames before them [N, greatest lag, inputs], these are the values of each unit [N,
        T, units, own], its weight [N, T, units, 1], and the values of the whole contact [N, T,
        whole].
        """
        fields = self.scale * torch.cat(
            (frames.unsqueeze(2), changes_of(frames, before, self.lags)), 2
        )
        x, y, z = fields.reshape(*fields.shape[:3], -1, 3).unbind(4)
        depth = z[:, :, :1]
        fit = RigidFit(x, y, torch.clamp(depth / 3 - 1, 0, 1), self.get_buffer("places"), 0.1)
        below = depth - fit.mean(depth)
        spread = fit.mean(below**2)
        slope = (
            fit.mean(below * fit.along_rigid) / spread.add(0.25) * fit.mean(depth) / fit.size.add(1)
        )  # 0: sticks, 1: slides
        weight = fit.weight.transpose(2, 3)
        own = torch.cat(
            (
                signed_log(depth).transpose(2, 3),
                weight,
                (fit.rigid[:, :, :1] / (depth.abs() + 3)).transpose(2, 3),
                *(
                    weight * signed_log(one).transpose(2, 3)
                    for one in (fit.rigid, fit.rest, fit.along_rigid, z)
                ),
            ),
            3,
        )
        whole = torch.cat(
            (
                fit.size,
                fit.turn,
                fit.departure,
                slope,
                fit.mean(depth),
                torch.sqrt(spread.add(0.01)),
                fit.count,
            ),
            2,
        ).squeeze(3)
        return own, weight, signed_log(whole)

    def forward(self, frames: Tensor, state: State = None) -> tuple[Tensor, tuple[Tensor, ...]]:
        """Returns logits, and the state if the network has one (see the module)."""
        return with_latest(self, frames, state)


class SkinSlip(nn.Module):
    """skin_slip: departure of a skin's readings from a common change, through a GRU.

    A grip that tightens or relaxes changes the readings of all units by the same share, and the
    ratio of shear to normal reading of each unit stays. Slip and rocking move load between the
    units and change these ratios. All values are relative to the sum of the normal readings, so
    that the sensitivity of the device has no influence. Not published.

    The smaller of the changes along both axes is read, and the greater one is not: in recordings,
    a closing gripper shears a skin along one axis as much as slip does.

    | layer | output |
    |---|---|
    | readings of the units | units x 3 |
    | readings before each of `lags` frames, which a state holds | lags x units x 3 |
    | of each lag: common change, load moved between units, smaller change of ratios | 3 lags |
    | batch norm; linear, ReLU | 32 |
    | GRU | 32 |
    | linear | 2 |

    Args:
        lags: frames, in ascending order
        noise: of a reading, in the unit of the sensor
    """

    least = 1e-3  # share of the load below which a change is noise

    def __init__(self, inputs: int, classes: int, lags: tuple[int, ...], noise: float) -> None:
        super().__init__()
        self.lags, self.noise = lags, noise
        self.norm = nn.BatchNorm1d(3 * len(lags))
        self.rest = FrameGru(3 * len(lags), classes, width=32)

    def measures(self, frames: Tensor, before: Tensor) -> Tensor:
        """ln(1 + change/least) of the changes [N, T, 3 lags], from frames [N, T, inputs].

        `before`: the frames before them [N, greatest lag, inputs]. The changes, as shares of the
        load: the common one of each lag, then the load moved, then the change of the ratios.
        """
        change = changes_of(frames, before, self.lags) / self.noise
        change = change.reshape(*change.shape[:3], -1, 3)  # [N, T, lags, units, 3]
        middle = frames.reshape(*frames.shape[:2], 1, -1, 3) / self.noise - 0.5 * change
        normal, pressed = middle[..., 2], change[..., 2]
        load = normal.abs().sum(3, keepdim=True) + normal.shape[3]  # a unit is noise, at least
        common = pressed.sum(3, keepdim=True) / load
        moved = (pressed - common * normal) / load
        # The same ratio would change the shear by middle[..., :2]/normal pressed; 3: noise of `normal`.
        ratio = (pressed * normal / (normal**2 + 9)).unsqueeze(4)
        turned = (change[..., :2] - middle[..., :2] * ratio) / load.unsqueeze(4)
        values = torch.cat(
            (
                common.abs().squeeze(3),
                torch.sqrt((moved**2).sum(3) + 1e-12),
                torch.sqrt((turned**2).sum(3).amin(3) + 1e-12),
            ),
            2,
        )
        return torch.log(values.div(self.least).add(1))

    def after(self, measures: Tensor, state: State = None) -> tuple[Tensor, tuple[Tensor, ...]]:
        """Logits and the state, from measures()."""
        scaled = self.norm(measures.flatten(0, 1)).reshape(measures.shape)
        answer: tuple[Tensor, tuple[Tensor, ...]] = self.rest(scaled, state)
        return answer

    def forward(self, frames: Tensor, state: State = None) -> tuple[Tensor, tuple[Tensor, ...]]:
        """Returns logits, and the state if the network has one (see the module)."""
        before = (
            frames.new_zeros((frames.shape[0], self.lags[-1], frames.shape[2]))
            if state is None
            else state[0]
        )
        logits, after = self.after(
            self.measures(frames, before), None if state is None else state[1:]
        )
        return logits, (torch.cat((before, frames), 1)[:, -self.lags[-1] :], *after)


class NibRigid(nn.Module):
    """nib_rigid: departure of the taxels' shear from a rigid motion, through a GRU.

    The changes of the shear depart from those of such a motion. Not published.

    Nibs that stick to a flat object lean as it moves, so the shear of the taxels changes as a rigid
    motion. The images si are means of five; a change in one image is a fifth of the change of a
    single image in five, and has less delay.

    | layer | output |
    |---|---|
    | si of nine taxels, fl, fr, counts | 40 |
    | changes in 30, 100, 300 and 600 ms; a state holds the latest 60 frames | 4 x 40 |
    | of each taxel and change: rigid part, departure, its part along the rigid one, load | 9 x 16 |
    | batch norm, linear, ReLU; mean and maximum of all taxels | 2 x 16 |
    | of each change: size of the motion, turn, departure, load; shear and load of fl, fr | 4 x 8 |
    | batch norm of the 32; linear of all, ReLU | 48 |
    | GRU | 48 |
    | linear | 2 |
    """

    def __init__(self, inputs: int, classes: int, lags: tuple[int, ...] = (3, 10, 30, 60)) -> None:
        super().__init__()
        self.lags = lags
        self.register_buffer("places", grid_places(3, 3))
        self.after = UnitsAndWhole(4 * len(lags), 8 * len(lags), classes)

    def measures(self, frames: Tensor, before: Tensor) -> tuple[Tensor, Tensor, Tensor]:
        """Values of the taxels and of the contact, from frames [N, T, 40].

        With the frames before them [N, greatest lag, 40], these are the values of each taxel [N, T,
        9, own], its weight [N, T, 9, 1], and the values of the whole contact [N, T, whole].
        """
        changes = changes_of(frames, before, self.lags)
        west, north, east, south = changes[..., :36].reshape(*changes.shape[:3], 9, 4).unbind(4)
        fit = RigidFit(
            east - west,
            north - south,
            torch.ones_like(east[:1, :1, :1]),
            self.get_buffer("places"),
            1.0,
        )
        load = west + north + east + south
        own = torch.cat(
            [
                signed_log(one).transpose(2, 3)
                for one in (fit.rigid, fit.rest, fit.along_rigid, load)
            ],
            3,
        )
        first, second, third, fourth = changes[..., 36:].unbind(3)
        fast = torch.stack((first - second, third - fourth, first + second, third + fourth), 3)
        whole = torch.cat((fit.size, fit.turn, fit.departure, fit.mean(load), fast), 3).flatten(2)
        return own, torch.ones_like(own[..., :1]), signed_log(whole)

    def forward(self, frames: Tensor, state: State = None) -> tuple[Tensor, tuple[Tensor, ...]]:
        """Returns logits, and the state if the network has one (see the module)."""
        return with_latest(self, frames, state)


class MyrmexCnn(nn.Module):
    """Networks of the Myrmex ([meier2016], section 4, Table 2).

    32 channels and padding by 1 are assumed.

    | layer | net 1 | net 2 | net 3 |
    |---|---|---|---|
    | spectra of 12 x 12 taxels, 32 bins as channels | 32 x 12 x 12 | 32 x 12 x 12 | 32 x 12 x 12 |
    | convolution 3 x 3, tanh, max pool 2 x 2 | 32 x 6 x 6 | 32 x 6 x 6 | 32 x 6 x 6 |
    | convolution 3 x 3, tanh, max pool 2 x 2 | | 32 x 3 x 3 | 32 x 3 x 3 |
    | linear, tanh | 512 | 512 | 1024 |
    | linear | 3 | 3 | 3 |
    """

    def __init__(
        self, inputs: int, classes: int, convolutions: int, hidden: int, side: int = 12
    ) -> None:
        super().__init__()
        self.side = side
        bins = inputs // side**2
        layers: list[nn.Module] = []
        for i in range(convolutions):
            layers += [
                nn.Conv2d(bins if i == 0 else 32, 32, 3, padding=1),
                nn.Tanh(),
                nn.MaxPool2d(2),
            ]
            side //= 2
        layers += [
            nn.Flatten(),
            nn.Linear(32 * side**2, hidden),
            nn.Tanh(),
            nn.Linear(hidden, classes),
        ]
        self.layers = nn.Sequential(*layers)

    def forward(self, frames: Tensor) -> Tensor:
        """Returns logits, and the state if the network has one (see the module)."""
        images = frames.reshape(*frames.shape[:2], self.side, self.side, -1).permute(0, 1, 4, 2, 3)
        return each_frame(self.layers, images)


class BiotacCnn(nn.Module):
    """Grasp stability by tactile images ([zapata2019], section 5.1, Table 2).

    | layer | output |
    |---|---|
    | images of all fingers | fingers x rows x columns |
    | convolution 3 x 3, batch norm, ReLU | 32 x (rows - 2) x (columns - 2) |
    | linear, ReLU | units, 1024 |
    | linear | 2 |
    """

    def __init__(
        self, inputs: int, classes: int, rows: int = 12, columns: int = 11, units: int = 1024
    ) -> None:
        super().__init__()
        self.image = (inputs // (rows * columns), rows, columns)
        self.layers = nn.Sequential(
            nn.Conv2d(self.image[0], 32, 3),
            nn.BatchNorm2d(32),
            nn.ReLU(),
            nn.Flatten(),
            nn.Linear(32 * (rows - 2) * (columns - 2), units),
            nn.ReLU(),
            nn.Linear(units, classes),
        )

    def forward(self, frames: Tensor) -> Tensor:
        """Returns logits, and the state if the network has one (see the module)."""
        return each_frame(self.layers, frames.reshape(*frames.shape[:2], *self.image))


class BiotacGcn(nn.Module):
    """Grasp stability by a tactile graph ([zapata2019], section 5.1, Table 2 and Fig. 12).

    A graph convolution is y = A x W + b with A = D^-1/2 (A' + 1) D^-1/2 [kipf2017].

    | layer | output |
    |---|---|
    | electrodes of all fingers | 24 x fingers |
    | graph convolution, batch norm, ReLU, five times | 24 x 8, 8, 16, 16, 32 |
    | linear, ReLU | 128 |
    | linear | 2 |
    """

    def __init__(self, inputs: int, classes: int, adjacency: Tensor) -> None:
        super().__init__()
        nodes = len(adjacency)
        widths = [inputs // nodes, 8, 8, 16, 16, 32]
        self.register_buffer("adjacency", adjacency)
        self.weights = nn.ModuleList(nn.Linear(before, after) for before, after in pairwise(widths))
        self.norms = nn.ModuleList(nn.BatchNorm1d(after) for after in widths[1:])
        self.head = nn.Sequential(nn.Linear(32 * nodes, 128), nn.ReLU(), nn.Linear(128, classes))

    def forward(self, frames: Tensor) -> Tensor:
        """Returns logits, and the state if the network has one (see the module)."""
        adjacency = self.get_buffer("adjacency")
        nodes = frames.reshape(*frames.shape[:2], len(adjacency), -1)
        for weight, norm in zip(self.weights, self.norms, strict=True):
            nodes = torch.matmul(adjacency, torch.matmul(nodes, weight.weight.t())) + weight.bias
            nodes = torch.relu(norm(nodes.reshape(-1, nodes.shape[3])).reshape(nodes.shape))
        logits: Tensor = self.head(nodes.flatten(2))
        return logits


class BiotacLstm(nn.Module):
    """Direction of slip by LSTMs ([zapata2019], section 5.2, Table 3).

    Begins afresh with each window.

    | layer | output |
    |---|---|
    | five rows at 100 Hz | 5 x 24 |
    | LSTM, five times | 5 x 32 |
    | the last row | 32 |
    | linear, ReLU, twice | 32 |
    | linear | 7 |
    """

    def __init__(self, inputs: int, classes: int, layers: int = 5, rows: int = 5) -> None:
        super().__init__()
        self.history = rows
        self.memory = nn.LSTM(inputs, 32, layers, batch_first=True)
        self.head = nn.Sequential(dense(32, 32, 32), nn.Linear(32, classes))

    def forward(self, frames: Tensor) -> Tensor:
        """Returns logits, and the state if the network has one (see the module)."""
        clips = windows(frames, self.history)
        last = self.memory(clips.flatten(0, 1))[0][:, -1]
        logits: Tensor = self.head(last)
        return logits.reshape(*clips.shape[:2], -1)


class ConvLstm(nn.Module):
    """An LSTM whose gates are convolutions 3 x 3 ([shi2015], without peepholes).

    [M, T, C, H, W] to [M, T, channels, H, W].
    """

    def __init__(self, inputs: int, channels: int) -> None:
        super().__init__()
        self.channels = channels
        self.gates = nn.Conv2d(inputs + channels, 4 * channels, 3, padding=1)

    def forward(self, frames: Tensor) -> Tensor:
        """The state is zero before the first frame."""
        hidden = frames.new_zeros(
            (frames.shape[0], self.channels, frames.shape[3], frames.shape[4])
        )
        cell, all_hidden = hidden, []
        for t in range(frames.shape[1]):
            enter, forget, update, leave = self.gates(torch.cat((frames[:, t], hidden), 1)).chunk(
                4, 1
            )
            cell = torch.sigmoid(forget) * cell + torch.sigmoid(enter) * torch.tanh(update)
            hidden = torch.sigmoid(leave) * torch.tanh(cell)
            all_hidden.append(hidden)
        return torch.stack(all_hidden, 1)


class BiotacConvLstm(nn.Module):
    """Direction of slip by convolutional LSTMs ([zapata2019], section 5.2, Table 3).

    The state is zero at the start of each window.

    The paper has five layers of 32 filters, which take 30 times as long to train as two of 8.

    | layer | output |
    |---|---|
    | five images at 100 Hz | 5 x rows x columns |
    | ConvLSTM 3 x 3, `layers` times | 5 x filters x rows x columns |
    | the last image, global average | filters |
    | linear, ReLU, twice | 32 |
    | linear | 7 |
    """

    def __init__(
        self,
        inputs: int,
        classes: int,
        rows: int = 12,
        columns: int = 11,
        layers: int = 2,
        filters: int = 8,
        frames: int = 5,
    ) -> None:
        super().__init__()
        self.history = frames
        self.image = (rows, columns)
        self.memory = nn.Sequential(
            *(ConvLstm(1 if i == 0 else filters, filters) for i in range(layers))
        )
        self.head = nn.Sequential(dense(filters, 32, 32), nn.Linear(32, classes))

    def forward(self, frames: Tensor) -> Tensor:
        """Returns logits, and the state if the network has one (see the module)."""
        clips = windows(frames, self.history)
        images = clips.reshape(-1, self.history, 1, *self.image)
        last = self.memory(images)[:, -1].mean((2, 3))
        logits: Tensor = self.head(last)
        return logits.reshape(clips.shape[0], clips.shape[1], -1)


class BiotacSlip(nn.Module):
    """biotac_slip: size and course of the changes of the electrodes, in any order, through a GRU.

    Each electrode has the same weights, so an answer does not depend on where the finger is
    touched, and levels, by which devices differ, are not used. Not published.

    | layer | output |
    |---|---|
    | two frames of five rows of 24 electrodes, counts | 2 x 120 |
    | the latest 50 rows, of which a state holds the earlier 40 | 50 x 24 |
    | of each electrode in 0.1, 0.2 and 0.5 s: deviation, deviation from a line, change | 24 x 9 |
    | batch norm, linear, ReLU; mean and maximum of all electrodes | 2 x 16 |
    | of each span: mean and largest deviation, deviation from lines, change, net change | 15 |
    | share of the 50 rows that the recording has so far | 1 |
    | batch norm of the 16; linear of all, ReLU | 48 |
    | GRU | 48 |
    | linear | 2 |

    Args:
        spans: rows over which changes are computed, ascending; the last one is a multiple of the
            five rows of a frame
        noise: counts; smaller deviations and changes are noise
    """

    history = 2
    electrodes = 24

    def __init__(
        self, inputs: int, classes: int, spans: tuple[int, ...] = (10, 20, 50), noise: float = 3.0
    ) -> None:
        super().__init__()
        self.step = inputs // self.electrodes
        self.spans, self.noise = spans, noise
        self.after = UnitsAndWhole(3 * len(spans), 5 * len(spans) + 1, classes)

    def measures(self, rows: Tensor) -> tuple[Tensor, Tensor, Tensor]:
        """Values of the electrodes and of the whole finger.

        Args:
            rows: [N, T, 24, R] the latest rows of each frame, counts; 0 before the recording

        Returns:
            Values of each electrode [N, T, 24, own], their weights [N, T, 24, 1], and the values of
            the whole finger [N, T, whole].
        """
        known = rows.sum(2, keepdim=True).gt(0).to(rows.dtype)  # [N, T, 1, R]
        values = (rows - rows[..., -1:]) * known
        time = torch.arange(rows.shape[3], dtype=rows.dtype)
        own, whole = [], []
        for span in self.spans:
            weight = known * time.ge(rows.shape[3] - span).to(rows.dtype)
            number = weight.sum(3)  # [N, T, 1]
            moment = weight * (time - ((weight * time).sum(3) / number).unsqueeze(3))
            spread = (moment**2).sum(3) / number + 1e-3
            mean, square, product = (
                torch.matmul(one, by.transpose(2, 3)).squeeze(3) / number  # [N, T, 24]
                for one, by in ((values, weight), (values**2, weight), (values, moment))
            )
            variance: Tensor = torch.relu(square - mean**2)
            change = product / spread * number / self.noise
            sd = torch.sqrt(variance.add(1e-3))
            unexplained: Tensor = torch.relu(variance - product**2 / spread)
            rest = torch.sqrt(unexplained.add(1e-3))
            own += [
                torch.log(sd.add(self.noise)),
                torch.log(rest.add(self.noise)),
                signed_log(change),
            ]
            whole += [
                torch.log(sd.mean(2) + self.noise),
                torch.log(sd.amax(2) + self.noise),
                torch.log(rest.mean(2) + self.noise),
                torch.log(change.abs().mean(2) + 1),
                signed_log(change.mean(2)),
            ]
        whole.append(known.mean(3).squeeze(2))
        electrodes = torch.stack(own, 3)
        return electrodes, torch.ones_like(electrodes[..., :1]), torch.stack(whole, 2)

    def forward(self, frames: Tensor, state: State = None) -> tuple[Tensor, tuple[Tensor, ...]]:
        """Returns logits, and the state if the network has one (see the module)."""
        count, earlier = frames.shape[1] - 1, self.spans[-1] // self.step - 2
        before = (
            frames.new_zeros((frames.shape[0], earlier, frames.shape[2]))
            if state is None
            else state[0]
        )
        joined = torch.cat((before, frames), 1)
        rows = windows(joined, earlier + 2)  # [N, T, frames, step x electrodes]
        rows = rows.reshape(frames.shape[0], count, self.spans[-1], self.electrodes)
        logits, after = self.after(
            *self.measures(rows.transpose(2, 3)), None if state is None else state[1:]
        )
        return logits, (joined[:, count : count + earlier], *after)


class BiotacGrasp(nn.Module):
    """biotac_grasp: changes of each electrode and of the pressure, through two GRUs.

    For each time span the same filters act across them. Not published.

    | layer | output |
    |---|---|
    | level and changes in four spans of 24 electrodes and 21 values of pressure | 5 x 45 |
    | linear across values | 5 x 16 |
    | linear, ReLU | 48 |
    | GRU, twice | 48 |
    | linear | 2 |
    """

    def __init__(self, inputs: int, classes: int, spans: int = 5) -> None:
        super().__init__()
        self.spans = spans
        self.across = nn.Linear(inputs // spans, 16)
        self.rest = FrameGru(spans * 16, classes, layers=2)

    def forward(self, frames: Tensor, state: State = None) -> tuple[Tensor, tuple[Tensor, ...]]:
        """Returns logits, and the state if the network has one (see the module)."""
        after: tuple[Tensor, tuple[Tensor, ...]] = self.rest(
            self.across(frames.reshape(*frames.shape[:2], self.spans, -1)).flatten(2), state
        )
        return after
