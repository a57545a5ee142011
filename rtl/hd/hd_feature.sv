// Quantises nine displacements to a frame, PillarsPerCycle pillars per cycle.
//
// Latency from the accepted sample to frame_valid_o: 9 / PillarsPerCycle + 3 cycles; a sample is
// accepted every 9 / PillarsPerCycle cycles. All registers wait until a frame is taken.

module hd_feature
  import hd_pkg::*;
#(
  parameter int unsigned PillarsPerCycle = NumPillars  // divides 9
) (
  input logic clk_i,
  input logic rst_ni,

  // Sample: displacements by pillar; first_i starts a window.
  input  logic                   valid_i,
  output logic                   ready_o,
  input  logic                   first_i,
  input  disp_t [NumPillars-1:0] disp_i,

  output logic   frame_valid_o,
  input  logic   frame_ready_i,
  output frame_t frame_o
);

  localparam int unsigned NumGroups = NumPillars / PillarsPerCycle;
  localparam int unsigned GroupWidth = index_width(NumGroups);
  localparam int unsigned LevelLatency = 4;

  if (NumPillars % PillarsPerCycle != 0) begin : gen_check_pillars
    $fatal(1, "PillarsPerCycle must be 1, 3 or 9");
  end

  typedef struct packed {
    logic     valid;  // the last group of a frame
    logic     first;
    context_t ctx;
  } tag_t;

  logic advance;
  assign advance = !frame_valid_o || frame_ready_i;

  // The context needs only comparisons and is known at once.
  context_t ctx;
  always_comb begin
    ctx = '0;
    for (int unsigned k = 0; k < NumContexts - 1; k++) begin
      if (disp_i[CentrePillar].z > DispWidth'(signed'(ContextEnd[k]))) ctx = context_t'(k + 1);
    end
  end

  // Groups: the first goes straight in, the others come from the held sample.
  disp_t [PillarsPerCycle-1:0] group;
  tag_t tag;

  if (NumGroups == 1) begin : gen_at_once
    assign ready_o = advance;
    assign group = disp_i;
    assign tag = '{valid: valid_i, first: first_i, ctx: ctx};
  end else begin : gen_in_groups
    localparam int unsigned NumHeld = NumPillars - PillarsPerCycle;
    localparam logic [GroupWidth-1:0] LastGroup = GroupWidth'(NumGroups - 1);

    logic [GroupWidth-1:0] group_q;
    disp_t [NumHeld-1:0] held_q;
    logic first_q;
    context_t ctx_q;
    logic accept;

    assign ready_o = advance && (group_q == '0);
    assign accept = valid_i && ready_o;

    always_ff @(posedge clk_i or negedge rst_ni) begin
      if (!rst_ni) begin
        group_q <= '0;
        held_q  <= '0;
        first_q <= 1'b0;
        ctx_q   <= '0;
      end else if (accept) begin
        group_q <= GroupWidth'(1);
        held_q  <= disp_i[NumPillars-1:PillarsPerCycle];
        first_q <= first_i;
        ctx_q   <= ctx;
      end else if (advance && (group_q != '0)) begin
        group_q <= (group_q == LastGroup) ? '0 : group_q + 1'b1;
        held_q  <= held_q >> (PillarsPerCycle * $bits(disp_t));
      end
    end

    assign group = (group_q == '0) ? disp_i[PillarsPerCycle-1:0] : held_q[PillarsPerCycle-1:0];
    assign tag = '{valid: group_q == LastGroup, first: first_q, ctx: ctx_q};
  end

  level_t [PillarsPerCycle-1:0] level;
  for (genvar p = 0; p < PillarsPerCycle; p++) begin : gen_level
    hd_level u_level (
      .clk_i,
      .advance_i(advance),
      .disp_i   (group[p]),
      .level_o  (level[p])
    );
  end

  // Delays the frame's own data like its last group.
  tag_t [LevelLatency-1:0] late_q;
  always_ff @(posedge clk_i or negedge rst_ni) begin
    if (!rst_ni) begin
      late_q <= '0;
    end else if (advance) begin
      late_q <= {late_q[LevelLatency-2:0], tag};
    end
  end

  assign frame_valid_o = late_q[LevelLatency-1].valid;
  assign frame_o.first = late_q[LevelLatency-1].first;
  assign frame_o.ctx = late_q[LevelLatency-1].ctx;

  if (NumGroups == 1) begin : gen_levels_at_once
    assign frame_o.level = level;
  end else begin : gen_levels_in_groups
    localparam int unsigned NumGathered = NumPillars - PillarsPerCycle;
    level_t [NumGathered-1:0] gathered_q;
    level_t [NumPillars-1:0] levels;
    assign levels = {level, gathered_q};
    always_ff @(posedge clk_i or negedge rst_ni) begin
      if (!rst_ni) begin
        gathered_q <= '0;
      end else if (advance) begin
        gathered_q <= levels[NumPillars-1:PillarsPerCycle];
      end
    end
    assign frame_o.level = levels;
  end

endmodule
