// Level of one pillar: the quantised ratio of tangential to whole displacement, |(x, y)| / |(x, y,
// z)|.
//
// By definition code = floor(sqrt(floor((tt << 14) / dd))) in Q1.7, with tt = x^2 + y^2 and dd = tt
// + z^2, and the level is the number of thresholds c that the code reaches. It needs neither a
// divider nor a root, because for integer c
//   floor(sqrt(floor(q))) >= c  <=>  sqrt(floor(q)) >= c  <=>  floor(q) >= c^2  <=>  q >= c^2
// (c and c^2 are integers, so taking the floor of the other side never crosses them). Hence
//   code >= c  <=>  tt * 2^14 >= c^2 * dd,
// and as every threshold is c = 4m, tt * 2^10 >= m^2 * dd. A pillar that does not move (dd = 0) has
// level 0.
//
// Four registers: squares, sums, multiples, level; one pillar per cycle. None has a reset, so that
// the squares fit into the registers of multipliers; the reader must know whether there was a
// displacement.

module hd_level
  import hd_pkg::*;
(
  input  logic   clk_i,
  input  logic   advance_i,  // every register keeps its value while low
  input  disp_t  disp_i,
  output level_t level_o     // of the displacement four cycles earlier
);

  localparam int unsigned SumWidth = 2 * DispWidth;       // (-2^15)^2 = 2^30, three of them < 2^32
  localparam int unsigned MultipleWidth = SumWidth + 10;  // m^2 <= 2^10

  typedef logic [SumWidth-1:0] sum_t;
  typedef logic [MultipleWidth-1:0] multiple_t;

  function automatic sum_t square(logic signed [DispWidth-1:0] value);
    logic signed [SumWidth-1:0] wide;
    wide = SumWidth'(value);
    return wide * wide;
  endfunction

  // Squares and sums.
  sum_t xx_q, yy_q, zz_q, tt_q, dd_q;

  always_ff @(posedge clk_i) begin
    if (advance_i) begin
      xx_q <= square(disp_i.x);
      yy_q <= square(disp_i.y);
      zz_q <= square(disp_i.z);
      tt_q <= xx_q + yy_q;
      dd_q <= xx_q + yy_q + zz_q;
    end
  end

  // Odd squares times dd, one adder each; the even ones are shifts of the odd ones.
  multiple_t dd1, dd9, dd25, dd49, dd81, dd121, dd169, dd225, dd289, dd625;
  assign dd1 = multiple_t'(dd_q);
  assign dd9 = dd1 + (dd1 << 3);
  assign dd25 = dd9 + (dd1 << 4);
  assign dd81 = dd9 + (dd9 << 3);
  assign dd49 = dd81 - (dd1 << 5);
  assign dd121 = dd49 + (dd9 << 3);
  assign dd169 = dd25 + (dd9 << 4);
  assign dd225 = dd25 + (dd25 << 3);
  assign dd289 = dd225 + (dd1 << 6);
  assign dd625 = dd225 + (dd25 << 4);

  localparam int unsigned NumOdd = 10;
  multiple_t odd_d[NumOdd], odd_q[NumOdd];
  sum_t tt_late_q;
  logic moves_q;
  assign odd_d = '{dd1, dd9, dd25, dd49, dd81, dd121, dd169, dd225, dd289, dd625};

  always_ff @(posedge clk_i) begin
    if (advance_i) begin
      odd_q     <= odd_d;
      tt_late_q <= tt_q;
      moves_q   <= dd_q != '0;
    end
  end

  // Threshold k is m = Odd * 2^Shift, with Odd as an index into odd_q: m = 1, 2, 4, 6, 8, 9, 10,
  // 12, 14, 16, 17, 18, 20, 22, 24, 25, 26, 28, 30, 32, the codes 4m at which the published levels
  // 1 to 20 begin.
  localparam int unsigned NumThresholds = NumLevels - 1;
  localparam int unsigned Odd[NumThresholds] = '{
      0, 0, 0, 1, 0, 4, 2, 1, 3, 0, 8, 4, 2, 5, 1, 9, 6, 3, 7, 0};
  localparam int unsigned Shift[NumThresholds] = '{
      0, 1, 2, 1, 3, 0, 1, 2, 1, 4, 0, 1, 2, 1, 3, 0, 1, 2, 1, 5};

  logic [NumThresholds-1:0] reached;
  for (genvar k = 0; k < NumThresholds; k++) begin : gen_threshold
    assign reached[k] = (multiple_t'(tt_late_q) << 10) >= (odd_q[Odd[k]] << (2 * Shift[k]));
  end

  // The thresholds ascend, so `reached` is a thermometer code and its length is the level.
  level_t level_d, level_q;
  always_comb begin
    level_d = '0;
    for (int unsigned k = 0; k < NumThresholds; k++) begin
      if (reached[k] && moves_q) level_d = level_t'(k + 1);
    end
  end

  always_ff @(posedge clk_i) begin
    if (advance_i) level_q <= level_d;
  end

  assign level_o = level_q;

endmodule
