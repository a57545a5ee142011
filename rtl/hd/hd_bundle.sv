// One slice of GS: the majority of 30 votes per bit (eq. 1-3), from nine pillars and three graphs.
//
// A complete graph of four pillars has four vertices and six edges. Its ten votes depend only on
// how many of its pillars are one: 6, 4, 4, 6, 10 votes for 0, 1, 2, 3, 4 ones, and ten minus that
// if the graph's own item is zero. All are even, so two graphs are represented by weights of two,
// four and eight. Carry-save adders, each on all bits of the slice at once, add these to the ten
// single votes. If ties go to one, one more vote turns "more than 15" into the carry of 16.

module hd_bundle
  import hd_pkg::*;
#(
  parameter int unsigned Width = 1000
) (
  input  logic                             tie_one_i,  // a bit with 15 of 30 votes is one
  input  logic [NumPillars-1:0][Width-1:0] level_i,    // CIM(f) of each pillar
  input  logic [  NumItems-1:0][Width-1:0] item_i,     // IM of pillars, then graphs
  output logic [     Width-1:0]            gs_o
);

  typedef logic [Width-1:0] slice_t;

  // Full adder on every bit: the carry is the majority, the sum is the parity.
  function automatic slice_t carry(slice_t a, slice_t b, slice_t c);
    return (a & b) | (c & (a ^ b));
  endfunction
  function automatic slice_t parity(slice_t a, slice_t b, slice_t c);
    return a ^ b ^ c;
  endfunction

  // Weight one: nine bound pillars, the centre's graph, the tie vote.
  slice_t [NumPillars-1:0] vote;
  for (genvar p = 0; p < NumPillars; p++) begin : gen_vote
    assign vote[p] = ~(level_i[p] ^ item_i[p]);
  end
  slice_t centre, tie;
  assign centre = ~(level_i[CentrePillar] ^ item_i[NumPillars+2]);
  assign tie = {Width{tie_one_i}};

  // Votes of a graph, by weight.
  typedef struct packed {
    slice_t eight;
    slice_t four;
    slice_t two;
  } graph_t;

  function automatic graph_t graph_votes(slice_t a, slice_t b, slice_t c, slice_t d, slice_t item);
    slice_t all, one_or_two;
    all = a & b & c & d;
    // The number of ones in binary has exactly one of its two low bits set when it is one or two.
    one_or_two = parity(a, b, c) ^ d ^ (carry(a, b, c) ^ (parity(a, b, c) & d));
    // 6, 4, 4, 6, 10 in twos is 3, 2, 2, 3, 5; five minus that is 2, 3, 3, 2, 0.
    return '{two: one_or_two ^ item, four: ~all, eight: all & item};
  endfunction

  graph_t corners, edges;
  assign corners = graph_votes(level_i[Corners[0]], level_i[Corners[1]], level_i[Corners[2]],
                               level_i[Corners[3]], item_i[NumPillars]);
  assign edges = graph_votes(level_i[Edges[0]], level_i[Edges[1]], level_i[Edges[2]],
                             level_i[Edges[3]], item_i[NumPillars+1]);

  // Eleven inputs of weight one give five carries of weight two.
  slice_t [2:0] row_sum;
  slice_t [4:0] two;
  for (genvar r = 0; r < 3; r++) begin : gen_row
    assign row_sum[r] = parity(vote[3*r], vote[3*r+1], vote[3*r+2]);
    assign two[r] = carry(vote[3*r], vote[3*r+1], vote[3*r+2]);
  end
  assign two[3] = carry(row_sum[0], row_sum[1], row_sum[2]);
  assign two[4] = carry(parity(row_sum[0], row_sum[1], row_sum[2]), centre, tie);

  // Seven inputs of weight two give three carries of weight four.
  slice_t two_a, two_b;
  slice_t [2:0] four;
  assign two_a = parity(two[0], two[1], two[2]);
  assign two_b = parity(two[3], two[4], corners.two);
  assign four[0] = carry(two[0], two[1], two[2]);
  assign four[1] = carry(two[3], two[4], corners.two);
  assign four[2] = carry(two_a, two_b, edges.two);

  // Five inputs of weight four give two carries of weight eight.
  slice_t four_a, eight_a, eight_b;
  assign four_a = parity(four[0], four[1], four[2]);
  assign eight_a = carry(four[0], four[1], four[2]);
  assign eight_b = carry(four_a, corners.four, edges.four);

  // No sum exceeds 31, so at most three of the four eights are set; any two of them make 16.
  assign gs_o = carry(eight_a, eight_b, corners.eight) |
                (edges.eight & (eight_a | eight_b | corners.eight));

endmodule
