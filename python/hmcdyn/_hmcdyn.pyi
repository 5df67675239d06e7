# SPDX-License-Identifier: BSD-3-Clause
# Written by python/tools/write_stubs.py; a test compares it with the module.
import enum
import os
from collections.abc import Sequence
from typing import Any

import numpy
import numpy.typing

_Array = numpy.typing.ArrayLike
_Boxes = Sequence[DetectionBox] | numpy.typing.ArrayLike
_Regions = Sequence[LabelRegion]
_Path = str | os.PathLike[str]
_Trajectory = str | os.PathLike[str] | numpy.typing.ArrayLike

__version__: str

class Ablation(enum.IntEnum):
    NONE = 0
    RS = 1
    DF = 2
    OPW = 3

class Alignment:
    @property
    def translation(self) -> numpy.typing.NDArray[numpy.float64]: ...
    @property
    def scale(self) -> float: ...
    @property
    def unique(self) -> bool: ...
    @property
    def rotation(self) -> numpy.typing.NDArray[numpy.float64]: ...

class AlignmentModel(enum.IntEnum):
    RIGID = 0
    SIMILARITY = 1

class AteResult:
    @property
    def error(self) -> Statistics: ...
    @property
    def alignment(self) -> Alignment: ...
    @property
    def timestamps(self) -> numpy.typing.NDArray[numpy.float64]: ...
    @property
    def errors(self) -> numpy.typing.NDArray[numpy.float64]: ...
    @property
    def estimated(self) -> numpy.typing.NDArray[numpy.float64]: ...
    @property
    def groundtruth(self) -> numpy.typing.NDArray[numpy.float64]: ...

class BeliefVerdictOptions:
    dragged_weight: float
    def __init__(self, *, dragged_weight: float = ...) -> None: ...

class BoxDecision:
    @property
    def verdict(self) -> BoxVerdict: ...
    @property
    def clusters(self) -> list[ClusterSummary]: ...
    @property
    def first_cluster(self) -> int: ...
    @property
    def strongest(self) -> int: ...
    @property
    def anchor(self) -> DepthAnchor: ...

class BoxDynamism:
    @property
    def boxes(self) -> list[BoxVerdict]: ...
    @property
    def threshold(self) -> numpy.typing.NDArray[numpy.float32]: ...

class BoxDynamismOptions:
    distance_threshold: float
    person_distance_threshold: float
    dynamic_ratio: float
    person_class_id: int
    def __init__(
        self,
        *,
        distance_threshold: float = ...,
        person_distance_threshold: float = ...,
        dynamic_ratio: float = ...,
        person_class_id: int = ...,
    ) -> None: ...

class BoxMembership:
    @property
    def offsets(self) -> numpy.typing.NDArray[numpy.uint64]: ...
    @property
    def indices(self) -> numpy.typing.NDArray[numpy.uint32]: ...

class BoxVerdict:
    @property
    def points(self) -> int: ...
    @property
    def measured(self) -> int: ...
    @property
    def dynamic(self) -> int: ...
    @property
    def is_dynamic(self) -> bool: ...

class ChiSquareOptions:
    sigma: float
    quantile: float
    def __init__(self, *, sigma: float = ..., quantile: float = ...) -> None: ...

class ClusterFilterOptions:
    min_cluster_size: int
    min_strongest_distance: float
    screening_ratio: float
    screening_floor: float
    place_unmatched_by_depth: bool
    def __init__(
        self,
        *,
        min_cluster_size: int = ...,
        min_strongest_distance: float = ...,
        screening_ratio: float = ...,
        screening_floor: float = ...,
        place_unmatched_by_depth: bool = ...,
    ) -> None: ...

class ClusterFilterResult:
    @property
    def clusters(self) -> list[ClusterSummary]: ...
    @property
    def is_dynamic(self) -> numpy.typing.NDArray[numpy.bool_]: ...
    @property
    def strongest(self) -> int: ...

class ClusterSummary:
    @property
    def points(self) -> int: ...
    @property
    def mean_distance(self) -> float: ...
    @property
    def mean_depth(self) -> float: ...
    @property
    def min_depth(self) -> float: ...
    @property
    def max_depth(self) -> float: ...
    @property
    def verdict(self) -> ClusterVerdict: ...

class ClusterVerdict(enum.IntEnum):
    STATIC = 0
    STRONGEST = 1
    SCREENED = 2
    DEPTH_NEIGHBOUR = 3

class Clustering:
    @property
    def label(self) -> numpy.typing.NDArray[numpy.int32]: ...
    @property
    def is_core(self) -> numpy.typing.NDArray[numpy.bool_]: ...
    @property
    def clusters(self) -> int: ...
    def __init__(self, label: _Array, clusters: int) -> None: ...

class ClusteringOptions:
    depth_scale: float
    distance_scale: float
    epsilon: float
    min_points: int
    order: float
    def __init__(
        self,
        *,
        depth_scale: float = ...,
        distance_scale: float = ...,
        epsilon: float = ...,
        min_points: int = ...,
        order: float = ...,
    ) -> None: ...

class DeltaUnit(enum.IntEnum):
    SECONDS = 0
    METRES = 1
    RADIANS = 2
    DEGREES = 3
    FRAMES = 4

class DepthAnchor:
    depth: float
    sigma: float
    def __init__(self, *, depth: float = ..., sigma: float = ...) -> None: ...

class DepthErrorModel:
    noise_floor: float
    noise_quadratic: float
    systematic_linear: float
    systematic_quadratic: float
    unshared: float
    def __init__(
        self,
        *,
        noise_floor: float = ...,
        noise_quadratic: float = ...,
        systematic_linear: float = ...,
        systematic_quadratic: float = ...,
        unshared: float = ...,
    ) -> None: ...

class DepthRansacOptions:
    variance_threshold: float
    confidence: float
    max_iterations: int
    seed: int
    def __init__(
        self,
        *,
        variance_threshold: float = ...,
        confidence: float = ...,
        max_iterations: int = ...,
        seed: int = ...,
    ) -> None: ...

class DepthRow(enum.IntEnum):
    NONE = 0
    DEPTH = 1
    DISPARITY = 2

class DetectionBox:
    x_min: float
    y_min: float
    x_max: float
    y_max: float
    class_id: int
    score: float
    def __init__(
        self,
        x_min: float,
        y_min: float,
        x_max: float,
        y_max: float,
        class_id: int = ...,
        score: float = ...,
    ) -> None: ...
    def contains(self, u: float, v: float) -> bool: ...

class DistanceKind(enum.IntEnum):
    TWO_VIEW = 0
    EGO_MOTION = 1
    LARGER = 2

class DynamicFeatureFilterOptions:
    flow: OpticalFlowOptions
    two_view: TwoViewOptions
    distance: DistanceKind
    ego_motion: EgoMotionOptions
    stage: FilterStageOptions
    flow_margin: float
    flow_in_boxes: int
    flow_background: int
    use_belief: bool
    surface: SurfaceDepthOptions
    belief: MotionBeliefOptions
    belief_verdict: BeliefVerdictOptions
    require_known_camera: bool
    max_median_distance: float
    def __init__(
        self,
        *,
        flow: OpticalFlowOptions | dict[str, Any] = ...,
        two_view: TwoViewOptions | dict[str, Any] = ...,
        distance: DistanceKind | str = ...,
        ego_motion: EgoMotionOptions | dict[str, Any] = ...,
        stage: FilterStageOptions | dict[str, Any] = ...,
        flow_margin: float = ...,
        flow_in_boxes: int = ...,
        flow_background: int = ...,
        use_belief: bool = ...,
        surface: SurfaceDepthOptions | dict[str, Any] = ...,
        belief: MotionBeliefOptions | dict[str, Any] = ...,
        belief_verdict: BeliefVerdictOptions | dict[str, Any] = ...,
        require_known_camera: bool = ...,
        max_median_distance: float = ...,
    ) -> None: ...

class DynamicFeatureFilterResult:
    @property
    def distance(self) -> numpy.typing.NDArray[numpy.float32]: ...
    @property
    def stage(self) -> FilterStageResult: ...
    @property
    def earlier(self) -> list[EarlierFrameReport]: ...
    @property
    def belief(self) -> MotionBelief: ...
    @property
    def camera_unknown(self) -> bool: ...

class EarlierFrameReport:
    @property
    def flow(self) -> FlowMatches: ...
    @property
    def motion(self) -> TwoViewEstimate: ...
    @property
    def used(self) -> bool: ...
    @property
    def camera_known(self) -> bool: ...
    @property
    def current_from_earlier(self) -> numpy.typing.NDArray[numpy.float64] | None: ...

class EgoMotionOptions:
    baseline_fx: float
    def __init__(self, *, baseline_fx: float = ...) -> None: ...

class FilterRule(enum.IntEnum):
    NONE = 0
    BOX = 1
    DYNAMIC_BOX = 2
    EPIPOLAR = 3
    TWO_THRESHOLD = 4
    CHI_SQUARE = 5
    DEPTH_RANSAC = 6
    HMC = 7

class FilterStageOptions:
    rule: FilterRule
    boxes: BoxDynamismOptions
    clustering: ClusteringOptions
    cluster_filter: ClusterFilterOptions
    weights: WeightOptions
    two_threshold: TwoThresholdOptions
    chi_square: ChiSquareOptions
    depth_ransac: DepthRansacOptions
    def __init__(
        self,
        *,
        rule: FilterRule | str = ...,
        boxes: BoxDynamismOptions | dict[str, Any] = ...,
        clustering: ClusteringOptions | dict[str, Any] = ...,
        cluster_filter: ClusterFilterOptions | dict[str, Any] = ...,
        weights: WeightOptions | dict[str, Any] = ...,
        two_threshold: TwoThresholdOptions | dict[str, Any] = ...,
        chi_square: ChiSquareOptions | dict[str, Any] = ...,
        depth_ransac: DepthRansacOptions | dict[str, Any] = ...,
    ) -> None: ...

class FilterStageResult:
    @property
    def label(self) -> numpy.typing.NDArray[numpy.uint8]: ...
    @property
    def weight(self) -> numpy.typing.NDArray[numpy.float32]: ...
    @property
    def cluster(self) -> numpy.typing.NDArray[numpy.int32]: ...
    @property
    def boxes(self) -> list[BoxDecision]: ...
    @property
    def frame(self) -> FrameDecision: ...

class FlowMatches:
    @property
    def u(self) -> numpy.typing.NDArray[numpy.float32]: ...
    @property
    def v(self) -> numpy.typing.NDArray[numpy.float32]: ...
    @property
    def found(self) -> int: ...

class FrameDecision:
    @property
    def mean_distance(self) -> float: ...
    @property
    def points(self) -> int: ...
    @property
    def measured(self) -> int: ...
    @property
    def boxes(self) -> int: ...
    @property
    def dynamic_boxes(self) -> int: ...
    @property
    def points_in_dynamic_boxes(self) -> int: ...
    @property
    def dynamic(self) -> int: ...
    @property
    def suspect(self) -> int: ...
    @property
    def unmatched(self) -> int: ...

class FrameFilter:
    @property
    def options(self) -> FrameFilterOptions: ...
    def __init__(
        self,
        options: FrameFilterOptions | None = ...,
        *,
        rule: FilterRule | str = ...,
        camera: PinholeCamera = ...,
        baselines: list[float] = ...,
        max_followed: int = ...,
        min_kept: int = ...,
        bridge: float = ...,
        drop_boxes_without_history: bool = ...,
        soft_weight_gate: float = ...,
        seed: int = ...,
        expert: DynamicFeatureFilterOptions | dict[str, Any] = ...,
    ) -> None: ...
    def filter(
        self,
        timestamp: float,
        gray: _Array,
        key_points: _Array,
        boxes: _Boxes | None = ...,
        *,
        depth: _Array | None = ...,
        point_depth: _Array | None = ...,
        labels: _Array | None = ...,
        regions: _Regions | None = ...,
        predicted_pose: _Array | None = ...,
        matched_timestamp: float = ...,
        matched_pixels: _Array | None = ...,
    ) -> FrameFilterResult: ...
    def set_pose(self, timestamp: float, camera_from_world: _Array) -> None: ...
    def reset(self) -> None: ...
    def mask(self) -> MotionMask | None: ...

class FrameFilterOptions:
    rule: FilterRule
    camera: PinholeCamera
    baselines: list[float]
    max_followed: int
    min_kept: int
    bridge: float
    drop_boxes_without_history: bool
    soft_weight_gate: float
    seed: int
    expert: DynamicFeatureFilterOptions
    def __init__(
        self,
        *,
        rule: FilterRule | str = ...,
        camera: PinholeCamera = ...,
        baselines: list[float] = ...,
        max_followed: int = ...,
        min_kept: int = ...,
        bridge: float = ...,
        drop_boxes_without_history: bool = ...,
        soft_weight_gate: float = ...,
        seed: int = ...,
        expert: DynamicFeatureFilterOptions | dict[str, Any] = ...,
    ) -> None: ...
    @staticmethod
    def paper() -> FrameFilterOptions: ...
    @staticmethod
    def robust() -> FrameFilterOptions: ...

class FrameFilterResult:
    @property
    def status(self) -> FrameFilterStatus: ...
    @property
    def keep(self) -> numpy.typing.NDArray[numpy.bool_]: ...
    @property
    def weight(self) -> numpy.typing.NDArray[numpy.float32]: ...
    @property
    def lambda_(self) -> numpy.typing.NDArray[numpy.float32]: ...
    @property
    def label(self) -> numpy.typing.NDArray[numpy.uint8]: ...
    @property
    def reason(self) -> numpy.typing.NDArray[numpy.uint8]: ...
    @property
    def mask(self) -> numpy.typing.NDArray[numpy.uint8]: ...
    @property
    def soft_weights(self) -> bool: ...
    @property
    def kept(self) -> int: ...
    @property
    def kept_for_number(self) -> int: ...
    @property
    def boxes(self) -> list[DetectionBox]: ...
    @property
    def bridged(self) -> int: ...
    @property
    def camera_from_world(self) -> numpy.typing.NDArray[numpy.float64] | None: ...
    @property
    def details(self) -> DynamicFeatureFilterResult: ...

class FrameFilterStatus(enum.IntEnum):
    FILTERED = 0
    NOTHING_TO_DO = 1
    NO_HISTORY = 2
    CAMERA_UNKNOWN = 3
    STAMP_NOT_RISING = 4

class FundamentalVerdict(enum.IntEnum):
    DEFINED = 0
    TOO_FEW_MATCHES = 1
    CAMERA_STILL = 2
    ILL_CONDITIONED = 3
    NO_CONSENSUS = 4

class KnownMotion(enum.IntEnum):
    AT_REST = 0
    UNKNOWN = 1
    MOVING = 2

class LabelRegion:
    label: int
    class_id: int
    score: float
    def __init__(self, label: int, class_id: int = ..., score: float = ...) -> None: ...

class MaskInstance:
    @property
    def number(self) -> int: ...
    @property
    def box(self) -> tuple[int, int, int, int]: ...
    @property
    def moves(self) -> bool: ...
    @property
    def area(self) -> float: ...
    @property
    def depth(self) -> float: ...
    @property
    def velocity(self) -> numpy.typing.NDArray[numpy.float32]: ...
    @property
    def has_velocity(self) -> bool: ...
    @property
    def decided_by(self) -> MaskReason: ...

class MaskLabel(enum.IntEnum):
    STATIC = 0
    UNKNOWN = 64
    STANDING = 128
    MOVING = 255

class MaskReason(enum.IntEnum):
    FREE_SPACE = 0
    GRAY = 1
    MEMORY = 2
    NAMED = 3

class MaskState(enum.IntEnum):
    GOOD = 0
    FIRST_FRAME = 1
    TIME_JUMP = 2
    CAMERA_JUMP = 3
    MOTION_UNKNOWN = 4
    MOTION_DOUBTFUL = 5
    NO_DEPTH = 6
    TOO_LARGE = 7

class MatchSource(enum.IntEnum):
    ALL = 0
    BACKGROUND = 1
    AT_REST = 2
    NOT_MOVING = 3
    PREDICTION = 4

class MotionBelief:
    @property
    def u(self) -> numpy.typing.NDArray[numpy.float32]: ...
    @property
    def v(self) -> numpy.typing.NDArray[numpy.float32]: ...
    @property
    def depth(self) -> numpy.typing.NDArray[numpy.float32]: ...
    @property
    def belief(self) -> numpy.typing.NDArray[numpy.float32]: ...
    @property
    def weight(self) -> numpy.typing.NDArray[numpy.float32]: ...
    def __init__(self) -> None: ...
    def __len__(self) -> int: ...

class MotionBeliefOptions:
    sigma: float
    memory_sigma: float
    depth_sigma_floor: float
    depth_sigma_quadratic: float
    still_distance: float
    moving_distance: float
    dynamic_evidence: float
    quiet_weight: float
    inferred_weight: float
    dragged_weight: float
    unmeasured_depth: float
    min_weight: float
    memory_gain: float
    memory_decay: float
    weight_cap: float
    dynamic_belief: float
    certain_weight: float
    def __init__(
        self,
        *,
        sigma: float = ...,
        memory_sigma: float = ...,
        depth_sigma_floor: float = ...,
        depth_sigma_quadratic: float = ...,
        still_distance: float = ...,
        moving_distance: float = ...,
        dynamic_evidence: float = ...,
        quiet_weight: float = ...,
        inferred_weight: float = ...,
        dragged_weight: float = ...,
        unmeasured_depth: float = ...,
        min_weight: float = ...,
        memory_gain: float = ...,
        memory_decay: float = ...,
        weight_cap: float = ...,
        dynamic_belief: float = ...,
        certain_weight: float = ...,
    ) -> None: ...

class MotionMask:
    @property
    def state(self) -> MaskState: ...
    @property
    def label(self) -> numpy.typing.NDArray[Any]: ...
    @property
    def belief(self) -> numpy.typing.NDArray[Any]: ...
    @property
    def instances(self) -> list[MaskInstance]: ...
    @property
    def moving_share(self) -> float: ...
    @property
    def agreement(self) -> float: ...

class MotionMaskEstimator:
    def __init__(
        self,
        camera: PinholeCamera,
        options: MotionMaskOptions | None = ...,
        *,
        working_width: int = ...,
        max_depth: float = ...,
        depth_error: DepthErrorModel | dict[str, Any] = ...,
        gray_tolerance: float = ...,
        min_area: float = ...,
        max_moving_share: float = ...,
        max_age: float = ...,
        max_gap: float = ...,
    ) -> None: ...
    def update(
        self,
        timestamp: float,
        depth: _Array,
        camera_from_world: _Array | None,
        gray: _Array | None = ...,
        boxes: _Boxes | None = ...,
        labels: _Array | None = ...,
        regions: _Regions | None = ...,
    ) -> MotionMask: ...
    def set_pose(self, timestamp: float, camera_from_world: _Array) -> None: ...
    def reset(self) -> None: ...

class MotionMaskOptions:
    working_width: int
    max_depth: float
    depth_error: DepthErrorModel
    gray_tolerance: float
    min_area: float
    max_moving_share: float
    max_age: float
    max_gap: float
    def __init__(
        self,
        *,
        working_width: int = ...,
        max_depth: float = ...,
        depth_error: DepthErrorModel | dict[str, Any] = ...,
        gray_tolerance: float = ...,
        min_area: float = ...,
        max_moving_share: float = ...,
        max_age: float = ...,
        max_gap: float = ...,
    ) -> None: ...

NOISE: int

class OpticalFlowOptions:
    window: int
    max_level: int
    guess_max_level: int
    max_iterations: int
    epsilon: float
    max_difference: float
    forward_backward: bool
    max_forward_backward_error: float
    def __init__(
        self,
        *,
        window: int = ...,
        max_level: int = ...,
        guess_max_level: int = ...,
        max_iterations: int = ...,
        epsilon: float = ...,
        max_difference: float = ...,
        forward_backward: bool = ...,
        max_forward_backward_error: float = ...,
    ) -> None: ...

PERSON_CLASS_ID: int

class PinholeCamera:
    fx: float
    fy: float
    cx: float
    cy: float
    def __init__(self, fx: float, fy: float, cx: float, cy: float) -> None: ...

class PointLabel(enum.IntEnum):
    STATIC = 0
    SUSPECT = 1
    DYNAMIC = 2
    UNMATCHED = 3

class PointReason(enum.IntEnum):
    OUTSIDE = 0
    AT_REST = 1
    APART = 2
    MOVES = 3
    MOVES_ALONG = 4
    ROOM = 5
    MASK = 6
    NO_HISTORY = 7
    FOR_NUMBER = 8

class PoseRefinementOptions:
    depth_row: DepthRow
    depth_error: DepthErrorModel
    baseline_fx: float
    loss: RobustLoss
    huber_two_rows: float
    huber_three_rows: float
    rounds: int
    plain_rounds: int
    chi2_two_rows: float
    chi2_three_rows: float
    weight_mode: WeightMode
    kappa: float
    min_depth: float
    max_iterations: int
    function_tolerance: float
    gradient_tolerance: float
    parameter_tolerance: float
    solver: PoseSolver
    def __init__(
        self,
        *,
        depth_row: DepthRow | str = ...,
        depth_error: DepthErrorModel | dict[str, Any] = ...,
        baseline_fx: float = ...,
        loss: RobustLoss | str = ...,
        huber_two_rows: float = ...,
        huber_three_rows: float = ...,
        rounds: int = ...,
        plain_rounds: int = ...,
        chi2_two_rows: float = ...,
        chi2_three_rows: float = ...,
        weight_mode: WeightMode | str = ...,
        kappa: float = ...,
        min_depth: float = ...,
        max_iterations: int = ...,
        function_tolerance: float = ...,
        gradient_tolerance: float = ...,
        parameter_tolerance: float = ...,
        solver: PoseSolver | str = ...,
    ) -> None: ...

class PoseRefinementResult:
    @property
    def camera_from_world(self) -> numpy.typing.NDArray[numpy.float64]: ...
    @property
    def covariance(self) -> numpy.typing.NDArray[numpy.float64] | None: ...
    @property
    def inlier(self) -> numpy.typing.NDArray[numpy.bool_]: ...
    @property
    def inliers(self) -> int: ...
    @property
    def usable_points(self) -> int: ...
    @property
    def skipped_points(self) -> int: ...
    @property
    def weight(self) -> numpy.typing.NDArray[numpy.float32]: ...
    @property
    def rounds(self) -> int: ...
    @property
    def iterations(self) -> int: ...
    @property
    def initial_cost(self) -> float: ...
    @property
    def final_cost(self) -> float: ...
    @property
    def termination(self) -> PoseRefinementTermination: ...
    @property
    def message(self) -> str: ...
    @property
    def succeeded(self) -> bool: ...

class PoseRefinementTermination(enum.IntEnum):
    CONVERGED = 0
    ITERATION_LIMIT = 1
    TOO_FEW_POINTS = 2
    TOO_FEW_INLIERS = 3
    NUMERICAL_FAILURE = 4

class PoseSolver(enum.IntEnum):
    COLLAPSED = 0
    CERES_PROBLEM = 1

class RobustLoss(enum.IntEnum):
    NONE = 0
    HUBER = 1

class RpeResult:
    @property
    def translation(self) -> Statistics: ...
    @property
    def rotation(self) -> Statistics: ...
    @property
    def begin_timestamps(self) -> numpy.typing.NDArray[numpy.float64]: ...
    @property
    def end_timestamps(self) -> numpy.typing.NDArray[numpy.float64]: ...
    @property
    def translation_errors(self) -> numpy.typing.NDArray[numpy.float64]: ...
    @property
    def rotation_errors(self) -> numpy.typing.NDArray[numpy.float64]: ...

class Statistics:
    @property
    def rmse(self) -> float: ...
    @property
    def mean(self) -> float: ...
    @property
    def median(self) -> float: ...
    @property
    def std(self) -> float: ...
    @property
    def min(self) -> float: ...
    @property
    def max(self) -> float: ...
    @property
    def count(self) -> int: ...

class SurfaceDepthOptions:
    own_radius: int
    own_share: float
    wide_radius: int
    enclosed_share: float
    behind_share: float
    flow_radius: int
    gap_floor: float
    gap_quadratic: float
    def __init__(
        self,
        *,
        own_radius: int = ...,
        own_share: float = ...,
        wide_radius: int = ...,
        enclosed_share: float = ...,
        behind_share: float = ...,
        flow_radius: int = ...,
        gap_floor: float = ...,
        gap_quadratic: float = ...,
    ) -> None: ...

class SurfaceDepths:
    @property
    def depth(self) -> numpy.typing.NDArray[numpy.float32]: ...
    @property
    def support(self) -> numpy.typing.NDArray[numpy.uint8]: ...
    @property
    def is_dragged(self) -> numpy.typing.NDArray[numpy.bool_]: ...

class SurfaceSupport(enum.IntEnum):
    MEASURED = 0
    ENCLOSED = 1
    BEHIND = 2
    BESIDE = 3
    NONE = 4

class TwoThresholdOptions:
    outside_threshold: float
    inside_threshold: float
    revert_share: float
    def __init__(
        self,
        *,
        outside_threshold: float = ...,
        inside_threshold: float = ...,
        revert_share: float = ...,
    ) -> None: ...

class TwoViewEstimate:
    @property
    def model(self) -> TwoViewModel: ...
    @property
    def verdict(self) -> FundamentalVerdict: ...
    @property
    def source(self) -> MatchSource: ...
    @property
    def matches(self) -> int: ...
    @property
    def inliers(self) -> int: ...
    @property
    def median_distance(self) -> float: ...
    @property
    def conditioning(self) -> float: ...

class TwoViewModel:
    @property
    def kind(self) -> TwoViewModelKind: ...
    @property
    def matrix(self) -> numpy.typing.NDArray[numpy.float64]: ...

class TwoViewModelKind(enum.IntEnum):
    NONE = 0
    FUNDAMENTAL = 1
    HOMOGRAPHY = 2
    IDENTITY = 3

class TwoViewOptions:
    min_matches: int
    min_background_matches: int
    min_background_cells: int
    inlier_threshold: float
    confidence: float
    max_iterations: int
    seed: int
    still_share: float
    still_displacement: float
    min_conditioning: float
    min_homography_share: float
    def __init__(
        self,
        *,
        min_matches: int = ...,
        min_background_matches: int = ...,
        min_background_cells: int = ...,
        inlier_threshold: float = ...,
        confidence: float = ...,
        max_iterations: int = ...,
        seed: int = ...,
        still_share: float = ...,
        still_displacement: float = ...,
        min_conditioning: float = ...,
        min_homography_share: float = ...,
    ) -> None: ...

class WeightMode(enum.IntEnum):
    FIXED = 0
    JOINT = 1

class WeightOptions:
    without_depth: float
    without_anchor: float
    def __init__(self, *, without_depth: float = ..., without_anchor: float = ...) -> None: ...

def apply_motion_belief(
    belief: MotionBelief,
    is_dragged: _Array,
    stage: FilterStageResult,
    options: MotionBeliefOptions | None = ...,
    verdict: BeliefVerdictOptions | None = ...,
) -> FilterStageResult: ...

def assign_to_boxes(u: _Array, v: _Array, depth: _Array, boxes: _Boxes) -> BoxMembership: ...

def assign_to_regions(region: _Array, regions: int) -> BoxMembership: ...

def ate(
    groundtruth: _Trajectory,
    estimate: _Trajectory,
    tolerance: float = ...,
    offset: float = ...,
    alignment: AlignmentModel | str = ...,
) -> AteResult: ...

def bounding_boxes(labels: _Array, regions: _Regions) -> list[DetectionBox]: ...

def cluster_box(
    depth: _Array,
    distance: _Array,
    options: ClusteringOptions | None = ...,
    *,
    depth_scale: float = ...,
    distance_scale: float = ...,
    epsilon: float = ...,
    min_points: int = ...,
    order: float = ...,
) -> Clustering: ...

def covered_share(boxes: _Boxes, width: int, height: int) -> float: ...

def density_clusters(
    points: _Array,
    options: ClusteringOptions | None = ...,
    *,
    depth_scale: float = ...,
    distance_scale: float = ...,
    epsilon: float = ...,
    min_points: int = ...,
    order: float = ...,
) -> Clustering: ...

def ego_motion_distances(
    camera: PinholeCamera,
    current_from_earlier: _Array,
    earlier_u: _Array,
    earlier_v: _Array,
    current_u: _Array,
    current_v: _Array,
    earlier_depth: _Array,
    current_depth: _Array,
    options: EgoMotionOptions | None = ...,
    *,
    baseline_fx: float = ...,
) -> numpy.typing.NDArray[Any]: ...

def epipolar_distances(
    fundamental: _Array,
    earlier_u: _Array,
    earlier_v: _Array,
    current_u: _Array,
    current_v: _Array,
) -> numpy.typing.NDArray[Any]: ...

def estimate_two_view_model(
    earlier_u: _Array,
    earlier_v: _Array,
    current_u: _Array,
    current_v: _Array,
    boxes: _Boxes | None = ...,
    options: TwoViewOptions | None = ...,
    *,
    min_matches: int = ...,
    min_background_matches: int = ...,
    min_background_cells: int = ...,
    inlier_threshold: float = ...,
    confidence: float = ...,
    max_iterations: int = ...,
    seed: int = ...,
    still_share: float = ...,
    still_displacement: float = ...,
    min_conditioning: float = ...,
    min_homography_share: float = ...,
) -> TwoViewEstimate: ...

def feature_factor(boxes: _Boxes, width: int, height: int, max_factor: float = ...) -> float: ...

def filter_clusters(
    depth: _Array,
    distance: _Array,
    threshold: _Array,
    clustering: Clustering,
    frame_mean_distance: float,
    options: ClusterFilterOptions | None = ...,
    *,
    min_cluster_size: int = ...,
    min_strongest_distance: float = ...,
    screening_ratio: float = ...,
    screening_floor: float = ...,
    place_unmatched_by_depth: bool = ...,
) -> ClusterFilterResult: ...

def filter_dynamic_features(
    earlier_gray: _Array,
    current_gray: _Array,
    u: _Array,
    v: _Array,
    depth: _Array,
    boxes: _Boxes | None = ...,
    labels: _Array | None = ...,
    regions: _Regions | None = ...,
    options: DynamicFeatureFilterOptions | None = ...,
    *,
    flow: OpticalFlowOptions | dict[str, Any] = ...,
    two_view: TwoViewOptions | dict[str, Any] = ...,
    distance: DistanceKind | str = ...,
    ego_motion: EgoMotionOptions | dict[str, Any] = ...,
    stage: FilterStageOptions | dict[str, Any] = ...,
    flow_margin: float = ...,
    flow_in_boxes: int = ...,
    flow_background: int = ...,
    use_belief: bool = ...,
    surface: SurfaceDepthOptions | dict[str, Any] = ...,
    belief: MotionBeliefOptions | dict[str, Any] = ...,
    belief_verdict: BeliefVerdictOptions | dict[str, Any] = ...,
    require_known_camera: bool = ...,
    max_median_distance: float = ...,
) -> DynamicFeatureFilterResult: ...

def filter_key_points(
    u: _Array,
    v: _Array,
    depth: _Array,
    distance: _Array,
    boxes: _Boxes,
    membership: BoxMembership | None = ...,
    options: FilterStageOptions | None = ...,
    *,
    rule: FilterRule | str = ...,
    clustering: ClusteringOptions | dict[str, Any] = ...,
    cluster_filter: ClusterFilterOptions | dict[str, Any] = ...,
    weights: WeightOptions | dict[str, Any] = ...,
    two_threshold: TwoThresholdOptions | dict[str, Any] = ...,
    chi_square: ChiSquareOptions | dict[str, Any] = ...,
    depth_ransac: DepthRansacOptions | dict[str, Any] = ...,
) -> FilterStageResult: ...

def fundamental_of_motion(
    camera: PinholeCamera,
    current_from_earlier: _Array,
) -> numpy.typing.NDArray[numpy.float64]: ...

def hard_weights(weights: _Array) -> numpy.typing.NDArray[Any]: ...

def kept_point_weights(
    depth: _Array,
    anchor: DepthAnchor,
    options: WeightOptions | None = ...,
    *,
    without_depth: float = ...,
    without_anchor: float = ...,
) -> numpy.typing.NDArray[Any]: ...

def model_distances(
    model: TwoViewModel | dict[str, Any],
    earlier_u: _Array,
    earlier_v: _Array,
    current_u: _Array,
    current_v: _Array,
) -> numpy.typing.NDArray[Any]: ...

def model_of_motion(camera: PinholeCamera, current_from_earlier: _Array, min_parallax: float = ...) -> TwoViewModel: ...

def read_trajectory(file: _Path) -> numpy.typing.NDArray[numpy.float64]: ...

def refine_pose(
    x: _Array,
    y: _Array,
    z: _Array,
    u: _Array,
    v: _Array,
    camera: PinholeCamera,
    initial: _Array,
    sigma: _Array | None = ...,
    depth: _Array | None = ...,
    weight: _Array | None = ...,
    depth_sigma: _Array | None = ...,
    options: PoseRefinementOptions | None = ...,
    *,
    depth_row: DepthRow | str = ...,
    depth_error: DepthErrorModel | dict[str, Any] = ...,
    baseline_fx: float = ...,
    loss: RobustLoss | str = ...,
    huber_two_rows: float = ...,
    huber_three_rows: float = ...,
    rounds: int = ...,
    plain_rounds: int = ...,
    chi2_two_rows: float = ...,
    chi2_three_rows: float = ...,
    weight_mode: WeightMode | str = ...,
    kappa: float = ...,
    min_depth: float = ...,
    max_iterations: int = ...,
    function_tolerance: float = ...,
    gradient_tolerance: float = ...,
    parameter_tolerance: float = ...,
    solver: PoseSolver | str = ...,
) -> PoseRefinementResult: ...

def regions_in(labels: _Array, background: int = ..., class_id: int = ...) -> list[LabelRegion]: ...

def regions_of_points(
    u: _Array,
    v: _Array,
    depth: _Array,
    labels: _Array,
    regions: _Regions,
) -> numpy.typing.NDArray[Any]: ...

def rpe(
    groundtruth: _Trajectory,
    estimate: _Trajectory,
    delta: float = ...,
    delta_unit: DeltaUnit | str = ...,
    offset: float = ...,
    scale: float = ...,
    tolerance: float | None = ...,
) -> RpeResult: ...

def static_depth(depth: _Array, label: _Array, keep_standing: bool = ...) -> numpy.typing.NDArray[Any]: ...

def surface_depths(
    image: _Array,
    u: _Array,
    v: _Array,
    options: SurfaceDepthOptions | None = ...,
    *,
    own_radius: int = ...,
    own_share: float = ...,
    wide_radius: int = ...,
    enclosed_share: float = ...,
    behind_share: float = ...,
    flow_radius: int = ...,
    gap_floor: float = ...,
    gap_quadratic: float = ...,
) -> SurfaceDepths: ...

def test_boxes(
    distance: _Array,
    boxes: _Boxes,
    membership: BoxMembership,
    options: BoxDynamismOptions | None = ...,
    *,
    distance_threshold: float = ...,
    person_distance_threshold: float = ...,
    dynamic_ratio: float = ...,
    person_class_id: int = ...,
) -> BoxDynamism: ...

def track_into_earlier_frame(
    current_gray: _Array,
    earlier_gray: _Array,
    u: _Array,
    v: _Array,
    options: OpticalFlowOptions | None = ...,
    *,
    window: int = ...,
    max_level: int = ...,
    guess_max_level: int = ...,
    max_iterations: int = ...,
    epsilon: float = ...,
    max_difference: float = ...,
    forward_backward: bool = ...,
    max_forward_backward_error: float = ...,
) -> FlowMatches: ...

def transfer_distances(
    homography: _Array,
    earlier_u: _Array,
    earlier_v: _Array,
    current_u: _Array,
    current_v: _Array,
) -> numpy.typing.NDArray[Any]: ...

def update_motion_belief(
    u: _Array,
    v: _Array,
    depth: _Array,
    distance: _Array,
    label: _Array,
    in_box: _Array,
    surface: SurfaceDepths,
    memory: MotionBelief,
    earlier_u: _Array | None = ...,
    earlier_v: _Array | None = ...,
    options: MotionBeliefOptions | None = ...,
    *,
    sigma: float = ...,
    memory_sigma: float = ...,
    depth_sigma_floor: float = ...,
    depth_sigma_quadratic: float = ...,
    still_distance: float = ...,
    moving_distance: float = ...,
    dynamic_evidence: float = ...,
    quiet_weight: float = ...,
    inferred_weight: float = ...,
    dragged_weight: float = ...,
    unmeasured_depth: float = ...,
    min_weight: float = ...,
    memory_gain: float = ...,
    memory_decay: float = ...,
    weight_cap: float = ...,
    dynamic_belief: float = ...,
    certain_weight: float = ...,
) -> MotionBelief: ...

def use_soft_weights(points_in_dynamic_boxes: int, points: int, gate: float = ...) -> bool: ...

def without(ablation: Ablation | str, options: FrameFilterOptions | dict[str, Any]) -> FrameFilterOptions: ...
