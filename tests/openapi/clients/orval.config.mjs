export default {
  beltflow: {
    input: { target: process.env.BELTFLOW_DOCUMENT },
    output: { target: "./orval_client.ts", client: "fetch", mode: "single", baseUrl: process.env.BELTFLOW_BASE },
  },
};
