// Top level for a gripper board: samples and decisions as frames on a UART (hd_host.sv).

module hd_top
  import hd_pkg::*;
#(
  parameter int unsigned Dim = 1000,
  parameter int unsigned Window = 15,
  parameter int unsigned SliceWidth = 50,
  parameter int unsigned PillarsPerCycle = 1,
  parameter bit BlockRam = 1'b1,
  parameter bit TieToOne = 1'b1,
  parameter int unsigned ClkPerBit = 100,  // 1 Mbaud at 100 MHz
  parameter string ItemFile = "IM.hex",
  parameter string LevelFile = "CIM.hex",
  parameter string ContextFile = "CM.hex",
  parameter string PrototypeFile = "AM.hex"
) (
  input  logic clk_i,
  input  logic rst_ni,    // released synchronously to clk_i
  input  logic uart_rx_i,
  output logic uart_tx_o
);

  localparam int unsigned DistWidth = $clog2(Dim + 1);

  logic rx_valid, rx_error, tx_valid, tx_ready;
  logic [7:0] rx_data, tx_data;
  logic sample_valid, sample_ready, sample_first;
  disp_t [NumPillars-1:0] sample_disp;
  logic valid, ready;
  class_e slip_class;
  logic [NumClasses-1:0][DistWidth-1:0] distance;

  hd_uart_rx #(
    .ClkPerBit(ClkPerBit)
  ) u_uart_rx (
    .clk_i,
    .rst_ni,
    .rx_i   (uart_rx_i),
    .valid_o(rx_valid),
    .data_o (rx_data),
    .error_o(rx_error)
  );

  hd_uart_tx #(
    .ClkPerBit(ClkPerBit)
  ) u_uart_tx (
    .clk_i,
    .rst_ni,
    .valid_i(tx_valid),
    .ready_o(tx_ready),
    .data_i (tx_data),
    .tx_o   (uart_tx_o)
  );

  hd_host #(
    .ClkPerBit(ClkPerBit),
    .DistWidth(DistWidth)
  ) u_host (
    .clk_i,
    .rst_ni,
    .rx_valid_i    (rx_valid),
    .rx_data_i     (rx_data),
    .rx_error_i    (rx_error),
    .tx_valid_o    (tx_valid),
    .tx_ready_i    (tx_ready),
    .tx_data_o     (tx_data),
    .sample_valid_o(sample_valid),
    .sample_ready_i(sample_ready),
    .sample_first_o(sample_first),
    .sample_disp_o (sample_disp),
    .valid_i       (valid),
    .ready_o       (ready),
    .class_i       (slip_class),
    .distance_i    (distance)
  );

  logic unused_frame_ready;
  hd_core #(
    .Dim            (Dim),
    .Window         (Window),
    .SliceWidth     (SliceWidth),
    .PillarsPerCycle(PillarsPerCycle),
    .BlockRam       (BlockRam),
    .ItemFile       (ItemFile),
    .LevelFile      (LevelFile),
    .ContextFile    (ContextFile),
    .PrototypeFile  (PrototypeFile)
  ) u_core (
    .clk_i,
    .rst_ni,
    .tie_one_i     (TieToOne),
    .sample_valid_i(sample_valid),
    .sample_ready_o(sample_ready),
    .sample_first_i(sample_first),
    .sample_disp_i (sample_disp),
    .frame_valid_i (1'b0),
    .frame_ready_o (unused_frame_ready),
    .frame_i       ('0),
    .valid_o       (valid),
    .ready_i       (ready),
    .class_o       (slip_class),
    .distance_o    (distance)
  );

endmodule
