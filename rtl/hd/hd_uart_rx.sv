// UART receiver, 8N1: start bit, eight data bits with the lowest first, stop bit.

module hd_uart_rx #(
  parameter int unsigned ClkPerBit = 100  // at least 8
) (
  input logic clk_i,
  input logic rst_ni,
  input logic rx_i,

  output logic       valid_o,  // high for one cycle: a byte arrived
  output logic [7:0] data_o,
  output logic       error_o   // high for one cycle: the byte has no stop bit
);

  localparam int unsigned TimerWidth = $clog2(ClkPerBit);
  typedef logic [TimerWidth-1:0] timer_t;
  localparam logic [3:0] StartBit = 4'd0;
  localparam logic [3:0] StopBit = 4'd9;

  // Two registers bring the line into the clock's domain; a third one detects its fall.
  logic [2:0] line_q;
  logic busy_q;
  logic [3:0] bit_q;
  timer_t timer_q;
  logic [7:0] data_q;

  logic line, falls, at_middle;
  assign line = line_q[1];
  assign falls = line_q[2] && !line_q[1];
  assign at_middle = busy_q && (timer_q == '0);

  always_ff @(posedge clk_i or negedge rst_ni) begin
    if (!rst_ni) begin
      line_q  <= '1;
      busy_q  <= 1'b0;
      bit_q   <= StartBit;
      timer_q <= '0;
      data_q  <= '0;
    end else begin
      line_q <= {line_q[1:0], rx_i};
      if (!busy_q) begin
        busy_q  <= falls;
        bit_q   <= StartBit;
        timer_q <= timer_t'(ClkPerBit / 2);
      end else if (!at_middle) begin
        timer_q <= timer_q - 1'b1;
      end else begin
        // A start bit that is not low at its middle was a disturbance.
        busy_q  <= (bit_q == StartBit) ? !line : (bit_q != StopBit);
        bit_q   <= bit_q + 1'b1;
        timer_q <= timer_t'(ClkPerBit - 1);
        if (bit_q != StartBit && bit_q != StopBit) data_q <= {line, data_q[7:1]};
      end
    end
  end

  assign valid_o = at_middle && (bit_q == StopBit) && line;
  assign error_o = at_middle && (bit_q == StopBit) && !line;
  assign data_o = data_q;

endmodule
