// Hamming distances of a query to three prototypes, one slice at a time, and the nearest prototype.
//
// Three registers: ones of groups of bits, their sum over the slices, the decision. Of equally near
// classes the higher one is taken, as in the published hardware.

module hd_distance
  import hd_pkg::*;
#(
  parameter int unsigned Dim = 1000,
  parameter int unsigned SliceWidth = Dim,
  localparam int unsigned DistWidth = $clog2(Dim + 1)
) (
  input logic clk_i,
  input logic rst_ni,
  input logic advance_i,

  // A slice of the query and of the prototypes.
  input slice_tag_t                            tag_i,
  input logic [SliceWidth-1:0]                 query_i,
  input logic [NumClasses-1:0][SliceWidth-1:0] prototype_i,

  // Valid three cycles after the last slice. ClassNone and zeros unless the window is full.
  output logic                                 valid_o,
  output class_e                               class_o,
  output logic [NumClasses-1:0][DistWidth-1:0] distance_o
);

  localparam int unsigned GroupWidth = 32;
  localparam int unsigned NumGroups = (SliceWidth + GroupWidth - 1) / GroupWidth;
  localparam int unsigned CountWidth = $clog2(GroupWidth + 1);
  typedef logic [DistWidth-1:0] dist_t;
  typedef logic [CountWidth-1:0] count_t;

  slice_tag_t count_tag_q;
  count_t [NumClasses-1:0][NumGroups-1:0] count_d, count_q;
  dist_t [NumClasses-1:0] sum_d, sum_q;
  logic sum_valid_q, sum_full_q;

  for (genvar k = 0; k < NumClasses; k++) begin : gen_class
    logic [SliceWidth-1:0] differ;
    logic [NumGroups*GroupWidth-1:0] padded;
    assign differ = query_i ^ prototype_i[k];
    assign padded = (NumGroups * GroupWidth)'(differ);
    for (genvar g = 0; g < NumGroups; g++) begin : gen_group
      assign count_d[k][g] = count_t'($countones(padded[g*GroupWidth+:GroupWidth]));
    end
    always_comb begin
      sum_d[k] = count_tag_q.first ? '0 : sum_q[k];
      for (int unsigned g = 0; g < NumGroups; g++) sum_d[k] = sum_d[k] + dist_t'(count_q[k][g]);
    end
  end

  class_e nearest;
  always_comb begin
    nearest = ClassNonSlip;
    if (sum_q[1] <= sum_q[0]) nearest = ClassIncipient;
    if (sum_q[2] <= sum_q[0] && sum_q[2] <= sum_q[1]) nearest = ClassGross;
  end

  always_ff @(posedge clk_i or negedge rst_ni) begin
    if (!rst_ni) begin
      count_tag_q <= '0;
      count_q     <= '0;
      sum_valid_q <= 1'b0;
      sum_full_q  <= 1'b0;
      sum_q       <= '0;
      valid_o     <= 1'b0;
      class_o     <= ClassNone;
      distance_o  <= '0;
    end else if (advance_i) begin
      count_tag_q <= tag_i;
      count_q     <= count_d;
      sum_valid_q <= count_tag_q.valid && count_tag_q.last;
      sum_full_q  <= count_tag_q.full;
      if (count_tag_q.valid) sum_q <= sum_d;
      valid_o <= sum_valid_q;
      if (sum_valid_q) begin
        class_o    <= sum_full_q ? nearest : ClassNone;
        distance_o <= sum_full_q ? sum_q : '0;
      end
    end
  end

endmodule
