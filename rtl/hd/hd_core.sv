// The CL-gstHDC slip detector: nine displacement vectors in, class and distances out.
//
// Latency from the accepted sample to valid_o: 9 / PillarsPerCycle + Dim / SliceWidth + 8 cycles. A
// sample is accepted every max(9 / PillarsPerCycle, Dim / SliceWidth) cycles. The first Window - 1
// decisions of a window are ClassNone.

module hd_core
  import hd_pkg::*;
#(
  parameter int unsigned Dim = 1000,
  parameter int unsigned Window = 15,
  parameter int unsigned SliceWidth = Dim,              // bits of a vector per cycle; divides Dim
  parameter int unsigned PillarsPerCycle = NumPillars,  // 1, 3 or 9
  parameter bit BlockRam = 1'b0,                        // CIM and history in block RAM
  parameter string ItemFile = "",                       // files of the memories, as for hd_encoder
  parameter string LevelFile = "",
  parameter string ContextFile = "",
  parameter string PrototypeFile = "",
  localparam int unsigned DistWidth = $clog2(Dim + 1)
) (
  input logic clk_i,
  input logic rst_ni,
  input logic tie_one_i,  // constant: value of a bit whose bundle is tied

  // Samples: displacements in 1/8 mm by pillar; sample_first_i starts a window.
  input  logic                   sample_valid_i,
  output logic                   sample_ready_o,
  input  logic                   sample_first_i,
  input  disp_t [NumPillars-1:0] sample_disp_i,

  // Frames that are already quantised. They enter behind hd_feature and overtake its samples.
  input  logic   frame_valid_i,
  output logic   frame_ready_o,
  input  frame_t frame_i,

  output logic                                 valid_o,
  input  logic                                 ready_i,
  output class_e                               class_o,
  output logic [NumClasses-1:0][DistWidth-1:0] distance_o
);

  logic feature_valid, feature_ready, encoder_valid, encoder_ready;
  frame_t feature_frame, encoder_frame;

  hd_feature #(
    .PillarsPerCycle(PillarsPerCycle)
  ) u_feature (
    .clk_i,
    .rst_ni,
    .valid_i      (sample_valid_i),
    .ready_o      (sample_ready_o),
    .first_i      (sample_first_i),
    .disp_i       (sample_disp_i),
    .frame_valid_o(feature_valid),
    .frame_ready_i(feature_ready),
    .frame_o      (feature_frame)
  );

  assign encoder_valid = feature_valid || frame_valid_i;
  assign encoder_frame = feature_valid ? feature_frame : frame_i;
  assign feature_ready = encoder_ready;
  assign frame_ready_o = encoder_ready && !feature_valid;

  hd_encoder #(
    .Dim          (Dim),
    .Window       (Window),
    .SliceWidth   (SliceWidth),
    .BlockRam     (BlockRam),
    .ItemFile     (ItemFile),
    .LevelFile    (LevelFile),
    .ContextFile  (ContextFile),
    .PrototypeFile(PrototypeFile)
  ) u_encoder (
    .clk_i,
    .rst_ni,
    .tie_one_i,
    .valid_i   (encoder_valid),
    .ready_o   (encoder_ready),
    .frame_i   (encoder_frame),
    .valid_o,
    .ready_i,
    .class_o,
    .distance_o
  );

endmodule
