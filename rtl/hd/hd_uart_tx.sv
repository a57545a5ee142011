// UART transmitter, 8N1: start bit, eight data bits with the lowest first, stop bit.

module hd_uart_tx #(
  parameter int unsigned ClkPerBit = 100
) (
  input logic clk_i,
  input logic rst_ni,

  input  logic       valid_i,
  output logic       ready_o,
  input  logic [7:0] data_i,

  output logic tx_o
);

  localparam int unsigned TimerWidth = $clog2(ClkPerBit);
  typedef logic [TimerWidth-1:0] timer_t;
  localparam int unsigned FrameBits = 10;

  logic [FrameBits-1:0] shift_q;
  logic [3:0] left_q;  // remaining bits, including this one
  timer_t timer_q;

  assign ready_o = left_q == '0;
  assign tx_o = shift_q[0];

  always_ff @(posedge clk_i or negedge rst_ni) begin
    if (!rst_ni) begin
      shift_q <= '1;
      left_q  <= '0;
      timer_q <= '0;
    end else if (valid_i && ready_o) begin
      shift_q <= {1'b1, data_i, 1'b0};
      left_q  <= 4'(FrameBits);
      timer_q <= timer_t'(ClkPerBit - 1);
    end else if (timer_q != '0) begin
      timer_q <= timer_q - 1'b1;
    end else if (left_q != '0) begin
      shift_q <= {1'b1, shift_q[FrameBits-1:1]};
      left_q  <= left_q - 1'b1;
      timer_q <= timer_t'(ClkPerBit - 1);
    end
  end

endmodule
