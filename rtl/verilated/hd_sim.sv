// hd_core for a simulator: the memories are loaded through ports, so that one verilated library
// works with any trained model. Never synthesised.

module hd_sim
  import hd_pkg::*;
#(
  parameter int unsigned Dim = 1000,
  parameter int unsigned Window = 15,
  parameter int unsigned SliceWidth = Dim,
  parameter int unsigned PillarsPerCycle = NumPillars,
  parameter bit BlockRam = 1'b0,
  localparam int unsigned DistWidth = $clog2(Dim + 1)
) (
  input logic clk_i,
  input logic rst_ni,
  input logic tie_one_i,

  // A row of a memory: 0 IM, 1 CIM, 2 CM, 3 AM.
  input logic           load_i,
  input logic [1:0]     load_memory_i,
  input logic [4:0]     load_row_i,
  input logic [Dim-1:0] load_vector_i,

  input  logic                   sample_valid_i,
  output logic                   sample_ready_o,
  input  logic                   sample_first_i,
  input  disp_t [NumPillars-1:0] sample_disp_i,

  input  logic                    frame_valid_i,
  output logic                    frame_ready_o,
  input  logic                    frame_first_i,
  input  context_t                frame_ctx_i,
  input  level_t [NumPillars-1:0] frame_level_i,

  output logic                                 valid_o,
  input  logic                                 ready_i,
  output class_e                               class_o,
  output logic [NumClasses-1:0][DistWidth-1:0] distance_o
);

  hd_core #(
    .Dim            (Dim),
    .Window         (Window),
    .SliceWidth     (SliceWidth),
    .PillarsPerCycle(PillarsPerCycle),
    .BlockRam       (BlockRam)
  ) u_core (
    .clk_i,
    .rst_ni,
    .tie_one_i,
    .sample_valid_i,
    .sample_ready_o,
    .sample_first_i,
    .sample_disp_i,
    .frame_valid_i,
    .frame_ready_o,
    .frame_i('{first: frame_first_i, ctx: frame_ctx_i, level: frame_level_i}),
    .valid_o,
    .ready_i,
    .class_o,
    .distance_o
  );

  localparam int unsigned NumSlices = Dim / SliceWidth;
  localparam int unsigned LogicStride = 2 ** $clog2(NumSlices);
  localparam int unsigned LevelStride = BlockRam ? NumSlices : LogicStride;

  always_ff @(posedge clk_i) begin
    if (load_i) begin
      for (int unsigned s = 0; s < NumSlices; s++) begin
        case (load_memory_i)
          2'd0:
          u_core.u_encoder.u_item_memory.gen_words.words[32'(load_row_i)*LogicStride+s] <=
              load_vector_i[s*SliceWidth+:SliceWidth];
          2'd1:
          u_core.u_encoder.u_level_memory.gen_words.words[32'(load_row_i)*LevelStride+s] <=
              load_vector_i[s*SliceWidth+:SliceWidth];
          2'd2:
          u_core.u_encoder.u_context_memory.gen_words.words[32'(load_row_i)*LogicStride+s] <=
              load_vector_i[s*SliceWidth+:SliceWidth];
          2'd3:
          u_core.u_encoder.u_prototype_memory.gen_words.words[32'(load_row_i)*LogicStride+s] <=
              load_vector_i[s*SliceWidth+:SliceWidth];
          default: ;
        endcase
      end
    end
  end

endmodule
